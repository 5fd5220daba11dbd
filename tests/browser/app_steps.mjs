// What a user of the app's page does, in steps that several checks take.
import assert from 'node:assert/strict';
import {openPage} from './browser.mjs';

// The page at the address that the program printed.
export async function openApp(browser, size, {address, origin}) {
  const opened = await openPage(browser, {...size, reducedMotion: 'reduce', acceptDownloads: true}, `${origin}/`);
  await opened.page.goto(address);
  await opened.page.locator('.splat, .empty').locator('visible=true').first().waitFor();
  return opened;
}

// Drops files ({name, type, bytes}) on the window.
export async function drop(page, files) {
  const transfer = await page.evaluateHandle((given) => {
    const data = new DataTransfer();
    for (const {name, type, base64} of given) {
      data.items.add(new File([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))], name, {type}));
    }
    return data;
  }, files.map(({name, type, bytes}) => ({name, type, base64: Buffer.from(bytes).toString('base64')})));
  for (const kind of ['dragenter', 'dragover', 'drop']) await page.dispatchEvent('body', kind, {dataTransfer: transfer});
  await transfer.dispose();
}

// Drops files on the library: the page of a project, whose id is the result.
export async function begin(page, files) {
  await drop(page, files);
  await page.waitForFunction(() => location.hash.startsWith('#/p/'));
  return page.evaluate(() => location.hash.slice(4));
}

export const get = (page, path) => page.evaluate(async (url) => (await fetch(url, {cache: 'no-store'})).json(), path);
export const projectOf = (page, id) => get(page, `api/projects/${id}`);

// Waits until `count` files are stored; each has a tile.
export async function stored(page, count) {
  await page.waitForFunction((n) => document.querySelectorAll('.photo[data-state=stored]').length === n, count, {timeout: 120000});
}

export const stateIs = (page, ...states) =>
  page.waitForFunction((all) => all.includes(document.querySelector('.project .state')?.dataset.state), states, {timeout: 900000});

// Deletes the project that is shown; where the desktop has no trash, the dialog is answered.
export async function remove(page, id) {
  await page.getByRole('button', {name: 'Delete', exact: true}).click();
  await page.locator('dialog[open], .library').first().waitFor();
  if (await page.locator('dialog[open]').count()) await page.getByRole('button', {name: 'Delete for good'}).click();
  await page.locator('.library').waitFor();
  const {projects} = await get(page, 'api/library');
  assert.ok(projects.every((project) => project.id !== id), 'it is gone');
}

export const noSidewaysScroll = async (page, what) =>
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth), `${what} scrolls sideways`);

// What the console may say where a refusal or an end of the program is what is tested.
export const beside = (problems, expected) => problems.filter((problem) => !expected.test(problem));
