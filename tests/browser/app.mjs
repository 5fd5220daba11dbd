// Tests of the page of `oraclegs app` in headless Chromium.
//   node tests/browser/app.mjs --program PATH    starts the program on a library of its own
//   node tests/browser/app.mjs --url ADDRESS     a running one, by the address that it printed; what kills it is left out
// ORACLEGS_FULL_DISK: the library of tests/faults/full_disk.cpp; without it the check of a full disk is left out.
// --screenshots FOLDER: keeps what the page looks like; --only NAME: one check.
import {existsSync, mkdirSync, mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {parseArgs} from 'node:util';
import * as checks from './app_checks.mjs';
import {flow} from './app_flow.mjs';
import * as media from './app_media.mjs';
import {makePhotos, startApp} from './app_program.mjs';
import {launch} from './browser.mjs';
import {checker} from './check.mjs';

const {values: options} = parseArgs({options: {
  program: {type: 'string'}, url: {type: 'string'}, screenshots: {type: 'string'}, only: {type: 'string'}}});
if (!options.program === !options.url) throw new Error('give --program PATH or --url ADDRESS');
const program = options.program && resolve(options.program);
const fullDisk = existsSync(process.env.ORACLEGS_FULL_DISK ?? '') && process.env.ORACLEGS_FULL_DISK;
const folder = mkdtempSync(join(tmpdir(), 'oraclegs_app_'));
if (options.screenshots) mkdirSync(options.screenshots, {recursive: true});

async function screenshot(page, name) {
  if (options.screenshots) await page.screenshot({path: join(options.screenshots, `${name}.png`), fullPage: true});
}

const {check, failed} = checker(options.only);
const start = (port) => startApp(program, folder, port);
const browser = await launch();
const photos = makePhotos(program, folder);
let app;
let small;  // on a small disk; ended also where its check fails
const startSmall = async (...how) => (small = await startApp(...how));
try {
  app = program ? await start() : {address: options.url, origin: new URL(options.url).origin};
  const given = {app, program, photos, folder, screenshot, start};
  await check('unreadable', () => checks.unreadable(browser, given));
  await check('many_files', () => checks.manyFiles(browser, given));
  await check('ten_thousand', () => media.tenThousand(browser, given));
  await check('heic', () => media.heic(browser, given));
  if (program) await check('media', () => media.media(browser, given));
  if (program && fullDisk) await check('full_disk', () => media.fullDisk(browser, {...given, start: startSmall, library: fullDisk}));
  await check('looks', () => checks.looks(browser, given));
  await check('keyboard', () => checks.keyboard(browser, given));
  await check('flow', () => flow(browser, given));
  if (program) await check('ends_and_comes_back', () => checks.endsAndComesBack(browser, given));
} finally {
  await browser.close();
  await app?.end?.();
  await small?.end();
  rmSync(folder, {recursive: true, force: true});
}
process.exit(failed() ? 1 : 0);
