// axe-core finds nothing to object to: the viewer, the page of a run that goes on, and the report, light and dark.
import assert from 'node:assert/strict';
import {pathToFileURL} from 'node:url';
import {objections} from './axe.mjs';
import {DESKTOP, openPage, PHONE} from './browser.mjs';
import {makeLive, makeSnapshot} from './fixture.mjs';
import {startServer} from './server.mjs';

export async function accessibility(browser, {assets, run, file}) {
  const files = new Map([...run.files, ['live/splat.splat', makeSnapshot(run.gaussians, 0)]]);
  const viewer = await startServer(assets, {document: run.document, live: null, files});
  const live = await startServer(assets, {
    document: {...run.document, splat: null, finished: false}, files, live: {...makeLive(300), warnings: ['One photo was not registered.']}});
  const found = [];
  const look = async (page, what) => found.push(...(await objections(page, what)));
  for (const [size, options] of [['desktop', DESKTOP], ['phone', PHONE]]) {
    for (const colorScheme of ['light', 'dark']) {
      const settings = {...options, colorScheme, reducedMotion: 'reduce'};  // no color in transition
      const name = (what) => `${what}, ${size}, ${colorScheme}`;
      await looksAtViewer(settings, viewer.url, name('viewer'));
      await looksAtViewer(settings, live.url, name('live'));
      await looksAtReport(settings, name('report'));
    }
  }
  await viewer.close();
  await live.close();
  assert.deepEqual(found, [], found.join('\n'));

  async function looksAtViewer(settings, url, what) {
    const {page, close} = await openPage(browser, settings, url);
    await page.goto(url);
    await page.locator('.stage[data-drawn]').waitFor();
    await look(page, what);
    if (settings.isMobile) await page.getByRole('button', {name: 'Panel'}).click();
    await page.locator('#view-7').click();
    await page.locator('.compare-layer').waitFor({state: 'visible'});
    await page.keyboard.press('p');
    await look(page, `${what}, comparing`);
    await page.keyboard.press('?');
    await look(page, `${what}, help`);
    await close();
  }

  async function looksAtReport(settings, what) {
    const url = pathToFileURL(file).href;
    const {page, close} = await openPage(browser, settings, url);
    await page.goto(url);
    await look(page, what);
    await page.getByRole('button', {name: 'Show in 3D'}).click();
    await page.locator('.stage[data-drawn]').waitFor();
    await page.getByLabel('Go to a view').selectOption('7');
    await page.locator('.compare-layer').waitFor({state: 'visible'});
    await look(page, `${what}, 3D`);
    await close();
  }
}
