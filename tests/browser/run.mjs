// Tests of the viewer and the report in headless Chromium; app.mjs tests the page of `oraclegs app`.
//   node tests/browser/run.mjs [--assets FOLDER]     against a small scene of known truth; bundles the pages when no folder is given
//   node tests/browser/run.mjs --url URL             the viewer of a running `oraclegs view`
//   node tests/browser/run.mjs --report FILE         a report.html
// --bound DB: how alike the 3D view and the program's renders must be (PSNR); --screenshots FOLDER: keeps what the pages look like;
// --only NAME: one check.
import {execFileSync} from 'node:child_process';
import {mkdirSync, mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';
import {parseArgs} from 'node:util';
import {launch} from './browser.mjs';
import {checker} from './check.mjs';
import {accessibility} from './accessibility.mjs';
import {makeRun} from './fixture.mjs';
import * as fixture from './fixture_checks.mjs';
import {live} from './live_checks.mjs';
import {writeReport} from './report_file.mjs';
import {cuts, modes} from './mode_checks.mjs';
import * as report from './report_checks.mjs';
import {startServer} from './server.mjs';
import * as viewer from './viewer_checks.mjs';
import {plainWords} from './word_checks.mjs';

const {values: options} = parseArgs({options: {
  assets: {type: 'string'}, url: {type: 'string'}, report: {type: 'string'}, bound: {type: 'string'}, screenshots: {type: 'string'}, only: {type: 'string'}}});
const given = Boolean(options.url || options.report);
const bound = Number(options.bound ?? (given ? 20 : 30));
const folder = mkdtempSync(join(tmpdir(), 'oraclegs_browser_'));
if (options.screenshots) mkdirSync(options.screenshots, {recursive: true});

async function screenshot(page, name, fullPage = false) {
  if (options.screenshots) await page.screenshot({path: join(options.screenshots, `${name}.png`), fullPage});
}

const {check, failed} = checker(options.only);

async function checkViewer(browser, url) {
  await check('viewer_desktop', () => viewer.desktop(browser, {url, bound, screenshot}));
  await check('viewer_phone', () => viewer.phone(browser, {url, screenshot}));
}

async function checkReport(browser, file) {
  await check('report_desktop', () => report.desktop(browser, {file, bound, screenshot}));
  await check('report_narrow', () => report.narrow(browser, {file, screenshot}));
}

async function checkFixture(browser) {
  const assets = resolve(options.assets ?? join(folder, 'assets'));
  if (!options.assets) execFileSync(process.execPath, [fileURLToPath(new URL('../../web/build.mjs', import.meta.url)), assets], {stdio: 'inherit'});
  const run = makeRun();
  const server = await startServer(assets, {document: run.document, live: null, files: run.files});
  const {url} = server;
  await checkViewer(browser, url);
  await check('provenance', () => fixture.classesHaveTheirColors(browser, {url, run}));
  await check('modes', () => modes(browser, {assets, screenshot}));
  await check('cuts', () => cuts(browser, {assets, screenshot}));
  await check('no_webgl', () => fixture.saysThatWebGLIsMissing(browser, {url}));
  await check('little', () => fixture.copesWithLittle(browser, {assets, run}));
  await check('live', () => live(browser, {assets, screenshot}));
  await server.close();
  const file = join(folder, 'report.html');
  await writeReport(file, assets, run);
  await checkReport(browser, file);
  await check('words', () => plainWords(browser, {assets, run, file}));
  await check('accessibility', () => accessibility(browser, {assets, run, file}));
}

const browser = await launch();
try {
  if (options.url) await checkViewer(browser, options.url.endsWith('/') ? options.url : `${options.url}/`);
  if (options.report) await checkReport(browser, resolve(options.report));
  if (!given) await checkFixture(browser);
} finally {
  await browser.close();
  rmSync(folder, {recursive: true, force: true});
}
process.exit(failed() ? 1 : 0);  // a check that failed may have left its server open
