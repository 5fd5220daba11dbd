// The viewer at a URL: of `oraclegs view`, or of the tests' own server.
import assert from 'node:assert/strict';
import {DESKTOP, openPage, PHONE} from './browser.mjs';
import * as checks from './scene_checks.mjs';
import {settled} from './picture.mjs';

const resolve = (url) => (url.startsWith('data:') ? url : `/files/${url}`);

async function open(browser, url, size) {
  const opened = await openPage(browser, size, url);
  await opened.page.goto(url);
  await opened.page.locator('.stage[data-drawn]').waitFor();
  const run = await opened.page.evaluate(() => globalThis.oraclegs.session.document);
  return {...opened, run};
}

// bound: PSNR of the 3D view against the program's render, dB.
export async function desktop(browser, {url, bound, screenshot}) {
  const {page, problems, close, run} = await open(browser, url, DESKTOP);
  assert.equal(await page.locator('h1').textContent(), run.title);
  await screenshot(page, 'viewer');
  const views = run.views?.length ?? 0;
  if (views > 0) {
    await choosesByKeyboard(page, views);
    await checks.comparesBySlider(page);
    const goTo = async (view) => {
      await page.locator(`#view-${view.id}`).click();
      await page.waitForFunction((id) => globalThis.oraclegs.scene.current?.id === id, view.id);
    };
    if (run.views.some((view) => view.render?.url)) await checks.showsTheRender(page, {run, resolve, bound, goTo});
    const id = await checks.clicksAFrustum(page);
    assert.equal(await page.locator('[role=option][aria-selected=true]').getAttribute('id'), `view-${id}`);
    await screenshot(page, 'viewer_compare');
    await page.locator('.stage canvas').focus();
    await page.keyboard.press('h');
    await settled(page);
  }
  if (views > 0) {
    const goTo = async (view) => {
      await page.locator(`#view-${view.id}`).click();
      await page.waitForFunction((id) => globalThis.oraclegs.scene.current?.id === id, view.id);
    };
    await checks.changesTheLens(page, {run, goTo});
    await checks.suggestsPhotos(page, run);
    await page.keyboard.press('h');
  }
  await checks.savesAnImage(page, {run, save: () => page.keyboard.press('i')});
  if (run.splat.support) {
    await checks.tintsAndHides(page, {range: page.getByLabel('Hide Gaussians with support below')});
    await page.keyboard.press('p');
    await settled(page);
    await screenshot(page, 'viewer_provenance');
    await page.keyboard.press('p');
  }
  await movesByKeys(page);
  await turnsToADoubleClick(page);
  await page.keyboard.press('?');
  await page.locator('dialog[open]').waitFor();
  await page.keyboard.press('Escape');
  await page.locator('dialog[open]').waitFor({state: 'detached'}).catch(() => {});
  assert.equal(await page.locator('dialog[open]').count(), 0, 'Escape closes the help');
  await checks.tabsThrough(page, 5);
  await checks.followsTheScheme(page);
  assert.deepEqual(problems, []);
  await close();
}

export async function phone(browser, {url, screenshot}) {
  const {page, problems, close, run} = await open(browser, url, PHONE);
  await checks.fitsTheWidth(page);
  await screenshot(page, 'viewer_phone');
  await showsTheSplatAlone(page);
  await page.getByRole('button', {name: 'Panel'}).tap();
  await page.locator('.side').waitFor({state: 'visible'});
  await checks.fitsTheWidth(page);
  await screenshot(page, 'viewer_phone_panel', true);
  if (run.views?.length) {
    const view = run.views[run.views.length - 1];
    await page.locator(`#view-${view.id}`).tap();
    await page.waitForFunction((id) => globalThis.oraclegs.scene.current?.id === id, view.id);
    await checks.fitsTheWidth(page);
  }
  assert.deepEqual(problems, []);
  await close();
}

// The first look has neither cameras nor panel over or beside the splat.
async function showsTheSplatAlone(page) {
  const cameras = () => page.evaluate(() => globalThis.oraclegs.scene.frusta.shown().length);
  assert.equal(await cameras(), 0);
  assert.equal(await page.locator('.side').isVisible(), false);
  const scrolls = await page.evaluate(() => document.documentElement.scrollHeight > window.innerHeight);
  assert.equal(scrolls, false, 'the 3D view fills the window');
  const button = page.getByRole('button', {name: 'Cameras'});
  if (!(await button.isVisible())) return;
  await button.tap();
  assert.ok((await cameras()) > 0, 'they can be switched on');
  await button.tap();
}

async function choosesByKeyboard(page, views) {
  await page.locator('.view-list').focus();
  await page.keyboard.press('Home');
  const first = await page.locator('[role=option][aria-selected=true]').getAttribute('id');
  await page.keyboard.press('ArrowDown');
  const second = await page.locator('[role=option][aria-selected=true]').getAttribute('id');
  if (views > 1) assert.notEqual(first, second);
  await page.waitForFunction((id) => `view-${globalThis.oraclegs.scene.current?.id}` === id, second);
  await page.locator('.compare-layer').waitFor({state: 'visible'});
  await page.locator('.details img').first().waitFor();
}

// What was clicked comes to the middle, and the camera turns around it.
async function turnsToADoubleClick(page) {
  await page.keyboard.press('c');  // a camera under the pointer would be flown to
  const box = await page.locator('.stage canvas').boundingBox();
  const at = {x: box.width * 0.55, y: box.height * 0.55};
  const look = () => page.evaluate(() => {
    const {scene} = globalThis.oraclegs;
    return {position: scene.pose.position.toArray(), turn: scene.pose.quaternion.toArray(), distance: scene.controls.distance};
  });
  const before = await look();
  await page.locator('.stage canvas').dblclick({position: at});
  await page.waitForFunction((distance) => globalThis.oraclegs.scene.controls.distance !== distance, before.distance);
  const after = await look();
  const moved = Math.hypot(...after.position.map((v, k) => v - before.position[k]));
  assert.ok(moved < 1e-6 * after.distance, 'the camera stays where it is');
  assert.notDeepEqual(after.turn, before.turn, 'and looks elsewhere');
  await page.keyboard.press('c');
}

async function movesByKeys(page) {
  const pose = () => page.evaluate(() => globalThis.oraclegs.scene.pose.position.toArray());
  const before = await pose();
  await page.locator('.stage canvas').focus();
  await page.keyboard.press('ArrowLeft', {delay: 150});
  assert.notDeepEqual(await pose(), before, 'arrow keys turn the camera');
}
