// Checks that need a scene of known truth: each class of support has its color, and is hidden at its bound; pages with
// little to show.
import assert from 'node:assert/strict';
import {DESKTOP, openPage} from './browser.mjs';
import {ballCenter} from './fixture.mjs';
import {pixel, settled, shownImage} from './picture.mjs';
import {project, SIZE} from './scene.mjs';
import {startServer} from './server.mjs';

// Of the balls' uncertainty, .1, .4, .6 and .9, in plasma.
const CERTAINTY_COLORS = [[64, 4, 156], [177, 42, 144], [224, 100, 98], [252, 200, 40]];
const CLASS_COLORS = [[0, 114, 178], [86, 180, 233], [240, 228, 66], [213, 94, 0]];

export async function classesHaveTheirColors(browser, {url, run}) {
  const {page, problems, close} = await openPage(browser, DESKTOP, url);
  await page.goto(url);
  await page.locator('.stage[data-drawn]').waitFor();
  const {camera} = run.document.views[0];
  const topOf = (i) => ballCenter(i).map((v, k) => v + [0, -0.3, -0.2][k]);  // not hidden by another ball
  const look = async () => {
    await settled(page);
    const image = await shownImage(page, SIZE.width, SIZE.height);
    return CLASS_COLORS.map((_, i) => {
      const p = project(camera, topOf(i));
      return pixel(image, p.x, p.y);
    });
  };
  await page.getByRole('radio', {name: 'how sure'}).check();
  for (const [i, seen] of (await look()).entries()) {  // ball 0 is sure, ball 3 is not
    const nearest = CERTAINTY_COLORS.map((color) => angle(color, seen)).reduce((best, v, k, all) => (v < all[best] ? k : best), 0);
    assert.equal(nearest, i, `ball ${i} is ${seen} where certainty is shown`);
  }
  await page.keyboard.press('p');
  const tinted = await look();
  tinted.forEach((seen, i) => {
    const nearest = CLASS_COLORS.map((color) => angle(color, seen)).reduce((best, v, k, all) => (v < all[best] ? k : best), 0);
    assert.equal(nearest, i, `ball ${i} is ${seen}`);
  });
  const range = page.getByLabel('Hide Gaussians with support below');
  await range.fill('0.5');  // the balls with support 0.4 and 0.1 go
  const left = await look();
  for (const i of [0, 1]) assert.ok(distance(left[i], tinted[i]) < 12, `ball ${i} stays`);
  for (const i of [2, 3]) assert.ok(distance(left[i], tinted[i]) > 40, `ball ${i} is hidden`);
  assert.deepEqual(problems, []);
  await close();
}

const distance = (a, b) => Math.hypot(...a.map((v, k) => v - b[k]));
const angle = (a, b) => Math.acos(Math.min(1, a.reduce((s, v, k) => s + v * b[k], 0) / (Math.hypot(...a) * Math.hypot(...b) + 1e-9)));

// A file without cameras, nothing at all, damaged bytes, no WebGL: a page with a message, without an exception.
export async function copesWithLittle(browser, {assets, run}) {
  const splat = {url: 'report/splat.spz', format: 'spz'};
  const cases = [
    [{document: {format: 1, kind: 'file', title: 'a.ply', splat}, live: null, files: run.files}, '.stage[data-drawn]'],
    [{document: null, live: null, files: run.files}, 'text=There is no splat yet'],
    [{document: {splat: {url: 'broken.spz', format: 'spz'}}, live: null, files: new Map([['broken.spz', Buffer.from('no splat')]])}, 'text=The splat cannot be shown'],
    [{document: {splat: {url: 'missing.spz', format: 'spz'}}, live: null, files: new Map()}, 'text=The splat cannot be shown'],
  ];
  for (const [state, expected] of cases) {
    const server = await startServer(assets, state);
    const {page, problems, close} = await openPage(browser, DESKTOP, server.url);
    await page.goto(server.url);
    await page.locator(expected).waitFor();
    if (state.document?.kind === 'file') await turnsUp(page);
    assert.deepEqual(problems.filter((p) => !p.includes('404')), []);
    await close();
    await server.close();
  }
}

// A file does not say where up is; the key U does.
async function turnsUp(page) {
  const up = () => page.evaluate(() => globalThis.oraclegs.scene.controls.frame.up.toArray());
  assert.deepEqual(await up(), [0, -1, 0]);
  await page.keyboard.press('u');
  assert.deepEqual(await up(), [0, 0, 1]);
  assert.deepEqual(await page.locator('.modes .choices label:visible').allTextContents(), ['color', 'depth', 'normals'], 'its marks are unknown');
  assert.equal(await page.locator('.views').isVisible(), false);
}

export async function saysThatWebGLIsMissing(browser, {url}) {
  const {page, problems, close} = await openPage(browser, DESKTOP, url);
  await page.addInitScript(() => {
    const real = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) { return kind.startsWith('webgl') ? null : real.call(this, kind, ...rest); };
  });
  await page.goto(url);
  await page.getByText('needs WebGL 2').waitFor();
  await page.locator('[role=option]').first().click();
  await page.locator('.details img').first().waitFor();
  assert.deepEqual(problems, []);
  await close();
}
