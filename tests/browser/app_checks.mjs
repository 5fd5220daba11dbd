// Parts of the app's page that need no finished splat.
import assert from 'node:assert/strict';
import {begin, beside, drop, get, noSidewaysScroll, openApp, projectOf, remove, stateIs, stored} from './app_steps.mjs';
import {tinyPhotos} from './app_program.mjs';
import {objections} from './axe.mjs';
import {DESKTOP, NARROW, PHONE} from './browser.mjs';

const text = (name, words, type = 'text/plain') => ({name, type, bytes: Buffer.from(words)});

// Bad files say why they are bad and stop no other; what is dropped twice is sent once.
export async function unreadable(browser, {app, photos}) {
  const {page, problems, close} = await openApp(browser, DESKTOP, app);
  const good = photos.slice(0, 5);
  const id = await begin(page, [good[0], text('notes.txt', 'hello'), text('broken.jpg', 'this is no picture', 'image/jpeg'), text('empty.png', '', 'image/png'), ...good.slice(1)]);
  await page.waitForFunction((n) => document.querySelectorAll('.photo[data-state=stored]:not(.marked)').length >= n, good.length);
  for (const name of ['notes.txt', 'broken.jpg', 'empty.png']) {
    const reason = page.locator('.photo', {hasText: name}).locator('.photo-reasons');
    await reason.waitFor();
    assert.ok((await reason.textContent()).length > 10, `${name} has a reason`);
  }
  const names = async () => (await projectOf(page, id)).files.map(({name}) => name).filter((name) => good.some((photo) => photo.name === name)).sort();
  assert.deepEqual(await names(), good.map(({name}) => name).sort());
  await drop(page, good);
  await page.getByText('All of these are here already').waitFor();
  assert.equal((await names()).length, good.length, 'nothing is stored twice');
  await page.getByRole('button', {name: `Remove ${good[0].name}`}).click();
  await page.waitForFunction(({path, name}) => fetch(path).then((answer) => answer.json()).then(({files}) => files.every((file) => file.name !== name)),
    {path: `api/projects/${id}`, name: good[0].name});
  await page.locator('.photo', {hasText: good[0].name}).waitFor({state: 'detached'});  // the page knows it, too
  await drop(page, [good[0]]);
  await page.locator('.photo[data-state=stored]', {hasText: good[0].name}).waitFor();
  await remove(page, id);
  await close();
  assert.deepEqual(beside(problems, /\b(404|409|415)\b/), []);
}

// All arrive, four at a time, and small pictures are made only of those that are seen.
export async function manyFiles(browser, {app}) {
  const {page, problems, close} = await openApp(browser, DESKTOP, app);
  const count = 200;
  await page.evaluate(() => {
    const {send} = XMLHttpRequest.prototype;
    globalThis.uploads = {open: 0, most: 0};
    XMLHttpRequest.prototype.send = function (...body) {
      globalThis.uploads.most = Math.max(globalThis.uploads.most, ++globalThis.uploads.open);
      this.addEventListener('readystatechange', () => { if (this.readyState === XMLHttpRequest.DONE) globalThis.uploads.open--; });
      send.apply(this, body);
    };
  });
  const id = await begin(page, tinyPhotos(count));
  await page.getByLabel('Name').fill('Two hundred');  // the page answers meanwhile
  await stored(page, count);
  const {most} = await page.evaluate(() => globalThis.uploads);
  assert.ok(most <= 4 && most > 1, `${most} uploads at a time`);
  assert.equal((await projectOf(page, id)).files.length, count);
  await page.locator('.photo img').first().waitFor();
  await page.waitForTimeout(500);
  const pictures = await page.locator('.photo img').count();
  assert.ok(pictures < count / 2, `${pictures} pictures were made`);
  await page.locator('.photo').last().scrollIntoViewIfNeeded();
  await page.locator('.photo').last().locator('img').waitFor();
  await remove(page, id);
  await close();
  assert.deepEqual(beside(problems, /\b(404|409)\b/), []);
}

// The name of what has the focus, as far as these checks need it.
const focused = (page) => page.evaluate(() => {
  const element = document.activeElement;
  return element.getAttribute('aria-label') ?? element.labels?.[0]?.textContent ?? element.textContent;
});

async function tabTo(page, name) {
  for (let i = 0; i < 80; i++) {
    if (name.test(await focused(page))) return;
    await page.keyboard.press('Tab');
  }
  assert.fail(`the Tab key does not reach ${name}; it is at ${await focused(page)}`);
}

// No mouse: from the library to a run, its end, and away with it.
export async function keyboard(browser, {app, photos}) {
  const {page, problems, close} = await openApp(browser, DESKTOP, app);
  const chosen = page.waitForEvent('filechooser');  // early: the browser has to wait for it
  await page.keyboard.press('Tab');
  assert.match(await focused(page), /Skip/);
  await page.keyboard.press('Enter');
  assert.equal(await page.evaluate(() => document.activeElement.id), 'main');
  await page.keyboard.press('Shift+Tab');
  await page.evaluate(() => document.activeElement.blur());
  await tabTo(page, /^New splat$/);
  await page.keyboard.press('Enter');
  await page.locator('h1', {hasText: 'New splat'}).waitFor();
  assert.equal(await focused(page), 'New splat', 'the title of the new page has the focus');
  await tabTo(page, /^Choose photos$/);
  await page.keyboard.press('Enter');
  const chooser = await chosen;
  await chooser.setFiles(photos.map(({name, type, bytes}) => ({name, mimeType: type, buffer: Buffer.from(bytes)})));
  await stored(page, photos.length);
  const id = await page.evaluate(() => location.hash.slice(4));
  await tabTo(page, /^Name/);
  await page.keyboard.press('Control+a');
  await page.keyboard.type('By hand');
  await tabTo(page, /^(Draft|Normal|High)/);
  const first = await focused(page);
  await page.keyboard.press('ArrowLeft');
  if (!/^Draft/.test(await focused(page))) await page.keyboard.press('ArrowLeft');
  assert.match(await focused(page), /^Draft/, `arrows choose; it was ${first}`);
  await tabTo(page, /^Make the splat$/);
  await page.keyboard.press('Enter');
  await stateIs(page, 'running', 'waiting');
  assert.equal((await projectOf(page, id)).name, 'By hand');
  await page.getByRole('button', {name: 'Stop'}).waitFor();
  await tabTo(page, /^Stop$/);
  await page.keyboard.press('Enter');
  await stateIs(page, 'stopped', 'new');
  await tabTo(page, /^Delete$/);
  await page.keyboard.press('Enter');
  await page.locator('dialog[open], .library').first().waitFor();
  if (await page.locator('dialog[open]').count()) {
    await tabTo(page, /^Delete for good$/);
    await page.keyboard.press('Enter');
  }
  await page.locator('.library').waitFor();
  assert.ok((await get(page, 'api/library')).projects.every((project) => project.id !== id));
  await close();
  assert.deepEqual(beside(problems, /\b(404|409)\b/), []);
}

// Words that nobody needs to know.
const JARGON = /\b(PSNR|SSIM|Gaussians?|iterations?|COLMAP|prox(y|ies)|proposals?|poses?|loss|workspace|registered|reconstruct\w*|training)\b/i;

const wordsOf = (page) => page.evaluate(() => {
  const hidden = [...document.querySelectorAll('*')].flatMap((element) => ['aria-label', 'title', 'alt', 'placeholder'].map((name) => element.getAttribute(name)));
  return [document.getElementById('page').textContent, ...hidden.filter(Boolean)].join('\n');
});

// axe has no objections, light and dark, wide and on a phone, where nothing scrolls sideways.
export async function looks(browser, {app, photos, screenshot}) {
  const found = [];
  for (const [size, options] of [['desktop', DESKTOP], ['phone', PHONE], ['narrow', NARROW]]) {
    const {page, close} = await openApp(browser, options, app);
    const look = async (what) => {
      assert.doesNotMatch(await wordsOf(page), JARGON, what);
      await noSidewaysScroll(page, `${what}, ${size}`);
      for (const colorScheme of size === 'narrow' ? [] : ['light', 'dark']) {
        await page.emulateMedia({colorScheme, reducedMotion: 'reduce'});
        found.push(...(await objections(page, `${what}, ${size}, ${colorScheme}`)));
        await screenshot(page, `app_${what.replaceAll(' ', '_')}_${size}_${colorScheme}`);
      }
    };
    await look('library');
    await page.getByRole('link', {name: 'New splat'}).click();
    await page.locator('.drop').waitFor();
    await look('new');
    const id = await begin(page, [...photos.slice(0, 3), text('a very long name of a file without any place to break it.txt', 'hello')]);
    await stored(page, 3);
    await look('photos');
    await page.getByRole('link', {name: 'Your splats', exact: true}).click();
    await page.locator('.splat').first().waitFor();
    await look('library with a splat');
    await page.locator(`.splat:has(a[href="#/p/${id}"])`).getByRole('button', {name: /^Rename/}).click();
    await page.locator('dialog[open] input').fill('Another name');
    await look('dialog');
    await page.keyboard.press('Enter');
    await page.locator('.splat-name', {hasText: 'Another name'}).waitFor();
    await page.locator('.splat-open', {hasText: 'Another name'}).click();
    await page.locator('h1', {hasText: 'Another name'}).waitFor();
    await remove(page, id);
    await close();
  }
  assert.equal(found.join('\n'), '');
}

// The program is killed and started again: the page says so both times, nothing is lost, and a run went on meanwhile.
export async function endsAndComesBack(browser, {start, app, photos}) {
  const {page, close} = await openApp(browser, DESKTOP, app);
  const id = await begin(page, photos);
  await stored(page, photos.length);
  await page.getByRole('radio', {name: /^Draft/}).check();
  await page.getByRole('button', {name: 'Make the splat'}).click();
  await stateIs(page, 'running');
  await app.end('SIGKILL');
  await page.getByText('The program has ended; start OracleGS again').waitFor();
  assert.equal(await page.locator('h1').isVisible(), true, 'the page stays');
  const again = await start(app.port);
  await page.getByText('Open the address that the program printed').waitFor();
  await page.goto(again.address);
  await page.goto(`${again.origin}/#/p/${id}`);
  await stateIs(page, 'running', 'finished');
  const stop = page.getByRole('button', {name: 'Stop'});
  if (await stop.isVisible()) await stop.click();
  await stateIs(page, 'stopped', 'finished', 'new');
  await remove(page, id);
  await page.getByRole('button', {name: 'Quit'}).click();
  await page.locator('dialog[open]').getByRole('button', {name: 'Quit'}).click();
  await page.getByText('OracleGS has ended').waitFor();
  await again.ended;
  await close();
}
