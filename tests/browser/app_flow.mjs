// From twelve dropped photos to a downloaded splat, with a reload at each stage and a second tab.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {readFileSync} from 'node:fs';
import {join} from 'node:path';
import {gunzipSync} from 'node:zlib';
import {compares, edits, withoutWebGL} from './app_edits.mjs';
import {begin, openApp, projectOf, remove, stateIs, stored} from './app_steps.mjs';
import {objections} from './axe.mjs';
import {DESKTOP} from './browser.mjs';

const NAME = 'Demo room';

// app: from startApp; program: path, or undefined where only a page is given.
export async function flow(browser, {app, program, photos, folder, screenshot}) {
  const {page, problems, close} = await openApp(browser, DESKTOP, app);
  const found = [];
  const look = async (what) => {
    for (const colorScheme of ['light', 'dark']) {
      await page.emulateMedia({colorScheme, reducedMotion: 'reduce'});
      found.push(...(await objections(page, `${what}, ${colorScheme}`)));
    }
    await page.emulateMedia({colorScheme: 'light', reducedMotion: 'reduce'});
  };

  const id = await begin(page, photos);
  await stored(page, photos.length);
  await page.reload();
  await stored(page, photos.length);
  await page.locator('.photo img').first().waitFor();
  assert.deepEqual((await projectOf(page, id)).files.map(({name}) => name).sort(), photos.map(({name}) => name).sort());
  await asksItsQuestions();
  const other = await page.context().newPage();
  await other.goto(page.url());
  await runs();
  await shows();
  await downloads();
  await edits(page, id, look);
  await withoutWebGL(browser, app, id);
  if (program) await compares(page, join(folder, 'library'));
  await page.getByRole('tab', {name: 'Splat'}).click();
  await remove(page, id);
  await other.getByText('There is no such splat').waitFor();
  await close();
  assert.deepEqual(problems.filter((problem) => !/404|409/.test(problem)), []);  // it is gone; there is no trash
  assert.equal(found.join('\n'), '');

  async function asksItsQuestions() {
    await page.getByLabel('Name').fill(NAME);
    await page.getByRole('radio', {name: /^Draft/}).check();
    assert.match(await page.locator('.estimate').textContent(), /on this machine/);
    await page.locator('h1').getByText(NAME).waitFor();
    await look('before the start');
    await screenshot(page, 'app_new');
    await page.getByRole('button', {name: 'Make the splat'}).click();
    await stateIs(page, 'waiting', 'running');
    assert.equal((await projectOf(page, id)).quality, 'draft');
  }

  // Each stage is there again after a reload, and the other tab, which nobody reloads, shows the same.
  async function runs() {
    const seen = new Set();
    let framed = false;
    let paused = false;
    for (;;) {
      const {state, message, stages, can} = await projectOf(page, id);
      const stage = stages.find((one) => one.state === 'running')?.label;
      assert.ok(['waiting', 'running', 'finished'].includes(state), `${state}: ${message}`);
      if (state === 'finished') break;
      framed ||= (await page.locator('.view-frame').count()) === 1;
      if (state === 'running' && stage && !seen.has(stage)) {
        seen.add(stage);
        await page.reload();
        await page.locator('h1').getByText(NAME).waitFor();
        await page.locator('.stage-list li', {hasText: stage}).or(page.locator('.state[data-state=finished]')).first().waitFor();
        await other.locator('.stage-list li', {hasText: stage}).waitFor();
        if (seen.size === 1) await look('running');
        if (seen.size === 2) await screenshot(page, 'app_running');
      }
      if (!paused && seen.size >= 2 && can.includes('pause')) paused = await pauses();
      await page.waitForTimeout(300);
    }
    assert.ok(seen.size >= 2, `stages are shown: ${[...seen]}`);
    assert.ok(framed, 'the splat is shown while it is made');
    assert.ok(paused, 'the run was paused and went on');
    for (const tab of [page, other]) await stateIs(tab, 'finished');
  }

  async function pauses() {
    await page.getByRole('button', {name: 'Pause'}).click();
    const end = Date.now() + 60000;
    while ((await projectOf(page, id)).state === 'running' && Date.now() < end) await page.waitForTimeout(200);
    if ((await projectOf(page, id)).state === 'finished') return false;  // it was faster
    await stateIs(page, 'paused');
    await other.locator('.state[data-state=paused]').waitFor();
    await page.getByRole('button', {name: 'Resume'}).click();
    await stateIs(page, 'running', 'waiting', 'finished');
    return true;
  }

  async function shows() {
    const frame = page.frameLocator('.tab-view iframe');
    await frame.locator('.stage[data-drawn]').waitFor({timeout: 120000});
    assert.equal(await frame.locator('.side').isVisible(), false, 'the viewer leaves its panel folded');
    assert.match(await page.locator('.view-frame').getAttribute('title'), new RegExp(NAME));
    await look('result');
    await screenshot(page, 'app_result');
    await page.getByRole('tab', {name: 'Report'}).click();
    await page.frameLocator('.tab-report iframe').locator('h1').waitFor();
    await page.keyboard.press('ArrowLeft');
    assert.equal(await page.getByRole('tab', {name: /^Photos/}).getAttribute('aria-selected'), 'true');
    await stored(page, photos.length);
  }

  async function download(format) {
    const [file] = await Promise.all([
      page.waitForEvent('download', {timeout: 120000}), page.getByRole('button', {name: `Download ${format}`}).click()]);
    const path = join(folder, file.suggestedFilename());
    await file.saveAs(path);
    return path;
  }

  async function downloads() {
    const path = await download('SPZ');
    assert.match(path, /\.spz$/);
    const bytes = gunzipSync(readFileSync(path));
    assert.equal(bytes.subarray(0, 4).toString('latin1'), 'NGSP');
    const gaussians = bytes.readUInt32LE(8);
    assert.ok(gaussians > 100, `${gaussians} Gaussians`);
    if (program) {
      const said = execFileSync(program, ['info', path], {encoding: 'utf8'});
      assert.match(said.replaceAll(',', ''), new RegExp(`\\b${gaussians}\\b`), 'the program reads it back');
    }
    await page.locator('.exports a').first().waitFor();
  }
}
