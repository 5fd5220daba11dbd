// Depth and normals: each side of a cube of flat Gaussians has the color that its place and its direction call for.
import assert from 'node:assert/strict';
import {DESKTOP, openPage} from './browser.mjs';
import {pixel, settled, shownImage} from './picture.mjs';
import {makeCamera, makeSides, project, SIZE} from './scene.mjs';
import {startServer} from './server.mjs';
import {encodeSpz} from './splat_files.mjs';

const VIRIDIS = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37]];
const NEAR_COLOR = 16;  // of 255: neighbors and the background show through a little

export async function modes(browser, {assets, screenshot}) {
  const {gaussians, sides} = makeSides();
  const camera = makeCamera(-0.7);
  const document = {
    format: 1, kind: 'run', title: 'three sides', splat: {url: 'splat.spz', format: 'spz', gaussians: gaussians.length},
    place: {up: [0, -1, 0], center: [0, -0.3, 0], radius: 1.6}, views: [{id: 0, name: 'a', role: 'train', camera}]};
  const server = await startServer(assets, {document, live: null, files: new Map([['splat.spz', encodeSpz(gaussians)]])});
  const {page, problems, close} = await openPage(browser, DESKTOP, server.url);
  await page.goto(server.url);
  await page.locator('.stage[data-drawn]').waitFor();
  const look = async () => {
    await settled(page);
    const image = await shownImage(page, SIZE.width, SIZE.height);
    return sides.map(({center}) => {
      const p = project(camera, center);
      return pixel(image, p.x, p.y);
    });
  };
  const shows = () => page.locator('.modes input:checked + span').textContent();
  const own = await look();

  await page.keyboard.press('m');  // no support: depth follows
  assert.equal(await shows(), 'depth');
  const seen = await look();
  const {near, far} = await page.evaluate(() => globalThis.oraclegs.scene.range);
  const distances = gaussians.map(({position}) => distanceTo(camera, position)).sort((a, b) => a - b);
  const at = (share) => distances[Math.round(share * (distances.length - 1))];
  assert.ok(Math.abs(near / at(0.02) - 1) < 1e-3 && Math.abs(far / at(0.98) - 1) < 1e-3, `from ${near} to ${far}`);
  sides.forEach(({center}, i) => {
    const nearness = (1 / distanceTo(camera, center) - 1 / far) / (1 / near - 1 / far);
    assert.ok(Math.abs(nearnessOf(seen[i]) - nearness) < 0.12, `depth of side ${i} is ${seen[i]}, not ${ramp(nearness).map(Math.round)}`);
  });
  assert.match(await page.locator('.modes .ramp').textContent(), /^\d.*\d$/);
  await screenshot(page, 'viewer_depth');

  await page.keyboard.press('m');
  assert.equal(await shows(), 'normals');
  (await look()).forEach((color, i) => isColor(color, normalColor(camera, sides[i].normal), `normal of side ${i}`));
  await screenshot(page, 'viewer_normals');
  await page.evaluate(() => globalThis.oraclegs.scene.controls.orbit(0.5, 0));
  await settled(page);
  const turned = await shownImage(page, SIZE.width, SIZE.height);
  assert.notDeepEqual(pixel(turned, 100, 75), normalColor(camera, sides[2].normal), 'the colors follow the camera');
  await page.keyboard.press('h');

  await page.keyboard.press('m');
  assert.equal(await shows(), 'color');
  (await look()).forEach((color, i) => isColor(color, own[i], 'the colors come back'));
  await page.keyboard.press('p');
  assert.equal(await shows(), 'color', 'without support there is no provenance');
  await page.getByRole('radio', {name: 'normals'}).check();
  isColor((await look())[0], normalColor(camera, sides[0].normal), 'the switch does what the key does');
  assert.deepEqual(problems, []);
  await close();
  await server.close();
}

// What the app's edits leave out is not drawn, and comes back; specks are those that float alone.
export async function cuts(browser, {assets, screenshot}) {
  const {gaussians, sides} = makeSides();
  const camera = makeCamera(-0.7);
  const speck = {position: [0, -1.3, 0], scales: [0.03, 0.03, 0.03], opacity: 0.99, color: [1, 1, 1]};
  const all = [...gaussians, speck];
  const left = ({position}) => position[0] < -0.45;
  const support = Uint8Array.from(all, (one) => (left(one) ? 50 : 255));
  const document = {
    format: 1, kind: 'run', title: 'three sides', views: [{id: 0, name: 'a', role: 'train', camera}], place: {up: [0, -1, 0], center: [0.3, -0.8, 0.1], radius: 0.6},
    splat: {url: 'splat.spz', format: 'spz', gaussians: all.length, support: {url: 'support.bin'}}};
  const files = new Map([['splat.spz', encodeSpz(all)], ['support.bin', Buffer.from(support)]]);
  const server = await startServer(assets, {document, live: null, files});
  const {page, problems, close} = await openPage(browser, DESKTOP, server.url);
  await page.goto(server.url);
  await page.locator('.stage[data-drawn]').waitFor();
  const places = [...sides.map(({center}) => center), speck.position];
  const seen = async (edits) => {
    await page.evaluate((data) => window.postMessage({edits: data}, window.location.origin), edits);
    await page.waitForFunction((data) => globalThis.oraclegs.scene.edits.name === data.name, edits);
    if (edits.remove_outliers) await page.waitForFunction(() => globalThis.oraclegs.scene.specks);
    await settled(page);
    const image = await shownImage(page, SIZE.width, SIZE.height);
    return places.map((place) => {
      const p = project(camera, place);
      return pixel(image, p.x, p.y)[0] > 60;
    });
  };
  const [L, T, F, S] = [0, 1, 2, 3];  // left, top and front side, and the speck
  const gone = (...which) => places.map((_, i) => !which.includes(i));
  assert.deepEqual(await seen({name: 'nothing'}), gone());
  assert.deepEqual(await seen({name: 'box', crop: 'box:-0.45,-0.75,-2,2,2,2'}), gone(L, T, S), 'a box');
  await screenshot(page, 'viewer_box');
  assert.ok(await page.evaluate(() => globalThis.oraclegs.scene.cut.edges.parent), 'its edges are shown');
  assert.deepEqual(await seen({name: 'ball', crop: 'auto'}), gone(L, F), 'what the cameras look at');
  assert.deepEqual(await seen({name: 'support', crop: 'none', min_support: 0.25}), gone(L), 'little support');
  assert.deepEqual(await seen({name: 'specks', remove_outliers: true}), gone(S), 'specks');
  assert.deepEqual(await seen({name: 'wrong', crop: 'box:1,2,none'}), gone(), 'no box');
  assert.deepEqual(problems, []);
  await close();
  await server.close();
}

function isColor(seen, wanted, what) {
  const off = Math.max(...seen.map((v, k) => Math.abs(v - wanted[k])));
  assert.ok(off < NEAR_COLOR, `${what} is ${seen}, not ${wanted.map(Math.round)}`);
}

function distanceTo(camera, point) {
  const {z, cx, cy} = project(camera, point);
  return Math.hypot(cx, cy, z);
}

function ramp(value) {
  const at = Math.min(Math.max(value, 0), 1) * (VIRIDIS.length - 1);
  const below = Math.min(Math.floor(at), VIRIDIS.length - 2);
  return VIRIDIS[below].map((v, k) => v + (VIRIDIS[below + 1][k] - v) * (at - below));
}

// Where on the ramp a color is. Gaussians in front of the one looked at blend in, so it is not exact.
function nearnessOf(color) {
  const off = (value) => Math.hypot(...ramp(value).map((v, k) => v - color[k]));
  const values = Array.from({length: 101}, (_, i) => i / 100);
  return values.reduce((best, value) => (off(value) < off(best) ? value : best));
}

function normalColor({world_to_camera: m}, n) {
  return [0, 4, 8].map((r) => 127.5 * (1 + m[r] * n[0] + m[r + 1] * n[1] + m[r + 2] * n[2]));
}
