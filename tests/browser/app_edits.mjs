// What is changed of a finished splat, and two of them side by side.
import assert from 'node:assert/strict';
import {cpSync, existsSync, readdirSync} from 'node:fs';
import {join} from 'node:path';
import {openApp, projectOf} from './app_steps.mjs';
import {DESKTOP} from './browser.mjs';

const PLAIN = {crop: 'none', up: 'auto', scale: 'auto', min_support: 0, max_uncertainty: 1, remove_outliers: false};

const said = (page, words) => page.locator('p.visually-hidden[role=status]', {hasText: words}).waitFor({state: 'attached'});

// The page is that of a finished splat. look(what): axe has no objections.
export async function edits(page, id, look) {
  const open = () => page.locator('summary', {hasText: 'Change'}).click();
  const kept = async () => (await projectOf(page, id)).edits;
  // What the 3D view leaves out; it is there before the program has kept it.
  const inView = async (wanted) => {
    const frame = await (await page.locator('.tab-view iframe').elementHandle()).contentFrame();
    await frame.waitForFunction((all) => Object.entries(all).every(([name, value]) => globalThis.oraclegs?.scene?.edits?.[name] === value), wanted);
  };
  const untilKept = (wanted) => page.waitForFunction(async ({path, all}) => {
    const {edits: now} = await (await fetch(path, {cache: 'no-store'})).json();
    return Object.entries(all).every(([name, value]) => now[name] === value);
  }, {path: `api/projects/${id}`, all: wanted});

  await page.getByRole('tab', {name: 'Splat'}).click();
  await open();
  await page.getByRole('radio', {name: /^A box/}).check();
  await page.waitForFunction(() => [...document.querySelectorAll('.box-grid input')].every(({value}) => value !== ''));  // around what is looked at
  const low = page.locator('.box-grid input').first();
  await low.fill('-1.5');  // nothing is kept before the field is left
  const [, ...rest] = await page.locator('.box-grid input').evaluateAll((inputs) => inputs.map(({value}) => value));
  const crop = `box:${[-1.5, ...rest].join(',')}`;
  await inView({crop});
  assert.notEqual((await kept()).crop, crop);
  await low.press('Tab');
  await page.getByRole('radio', {name: /^Hide what photos hardly show/}).check();
  await page.getByText('Kept: every download').waitFor();
  await page.getByLabel('Remove specks').check();
  await untilKept({crop, min_support: 0.25, remove_outliers: true});

  await page.getByRole('button', {name: 'Undo', exact: true}).click();
  await said(page, 'Undone: the specks.');
  await untilKept({crop, min_support: 0.25, remove_outliers: false});
  await page.keyboard.press('Control+z');
  await said(page, 'Undone: what is hidden.');
  await inView({crop, min_support: 0});
  await page.keyboard.press('Control+Shift+Z');
  await said(page, 'Redone: what is hidden.');
  await untilKept({crop, min_support: 0.25, remove_outliers: false});

  await page.reload();
  await open();
  assert.ok(await page.getByRole('radio', {name: /^A box/}).isChecked());
  assert.equal(await low.inputValue(), '-1.5');
  await inView({crop, min_support: 0.25});
  await look('changes');
  await measures();
  await page.getByRole('button', {name: 'Undo all of it'}).click();
  await page.getByText('All changes are undone').waitFor();
  assert.deepEqual(await kept(), PLAIN);
  await inView(PLAIN);

  // Two places in the 3D view and the length between them are a scale.
  async function measures() {
    await page.locator('summary', {hasText: 'By a length'}).click();
    const canvas = page.frameLocator('.tab-view iframe').locator('canvas');
    const box = await canvas.boundingBox();
    const points = [];
    for (const [label, x] of [['This is one end', 0.35], ['This is the other end', 0.6]]) {
      await canvas.dblclick({position: {x: box.width * x, y: box.height * 0.6}});
      const frame = await (await page.locator('.tab-view iframe').elementHandle()).contentFrame();
      await frame.waitForFunction(() => !globalThis.oraclegs.scene.flight);
      points.push(await frame.evaluate(() => globalThis.oraclegs.scene.focus.point));
      await page.getByRole('button', {name: label}).click();
    }
    const distance = Math.hypot(...points[0].map((v, k) => v - points[1][k]));
    assert.ok(distance > 0.01, `the ends are ${distance} apart`);
    await page.getByText('How long is that in meters?').waitFor();
    await page.getByLabel('Length between them').fill('2.5');
    await page.getByLabel('Length between them').press('Tab');
    await page.waitForFunction(async (path) => typeof (await (await fetch(path, {cache: 'no-store'})).json()).edits.scale === 'number', `api/projects/${id}`);
    const {scale} = await kept();
    assert.ok(Math.abs(scale / (2.5 / distance) - 1) < 1e-3, `${scale}, not ${2.5 / distance}`);
  }
}

// A second splat stands beside the first, each in a 3D view of its own. library: the folder of the app.
export async function compares(page, library) {
  const own = readdirSync(library).find((name) => existsSync(join(library, name, 'splat', 'point_cloud.ply')));
  cpSync(join(library, own, 'splat'), join(library, 'another splat'), {recursive: true});  // as `oraclegs reconstruct` would make it there
  await page.getByRole('tab', {name: 'Compare'}).click();
  await page.getByText('Choose the second one above').waitFor();
  await page.getByLabel('Beside it').selectOption({label: 'another splat'});
  const frames = page.locator('.pair-frames iframe');
  assert.equal(await frames.count(), 2);
  for (const i of [0, 1]) await page.frameLocator('.pair-frames iframe').nth(i).locator('.stage[data-drawn]').waitFor({timeout: 60000});
  assert.match(await frames.nth(1).getAttribute('title'), /another splat/);
  assert.notEqual(await frames.nth(0).getAttribute('src'), await frames.nth(1).getAttribute('src'));
}

// A browser without WebGL: words in place of the 3D view, and the download works. id: of a finished splat.
export async function withoutWebGL(browser, app, id) {
  const {page, problems, close} = await openApp(browser, DESKTOP, app);
  await page.addInitScript(() => {
    const real = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) { return kind.startsWith('webgl') ? null : real.call(this, kind, ...rest); };
  });
  await page.goto(`${app.origin}/#/p/${id}`);
  await page.reload();
  await page.frameLocator('.tab-view iframe').getByText('needs WebGL 2').waitFor();
  const [file] = await Promise.all([page.waitForEvent('download', {timeout: 120000}), page.getByRole('button', {name: 'Download SPZ'}).click()]);
  assert.match(file.suggestedFilename(), /\.spz$/);
  await page.locator('summary', {hasText: 'Change'}).click();
  await page.getByRole('radio', {name: /^A box/}).check();
  await page.getByText('Type the six numbers').waitFor();
  await page.getByRole('radio', {name: /^Everything/}).check();
  await close();
  assert.deepEqual(problems, []);
}
