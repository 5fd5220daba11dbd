// What else people drop: a zip, a video, HEIC, ten thousand files; and a disk that is full meanwhile.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {closeSync, mkdirSync, openSync, readFileSync, realpathSync, writeFileSync, writeSync} from 'node:fs';
import {join} from 'node:path';
import {begin, beside, openApp, projectOf, remove, stateIs, stored} from './app_steps.mjs';
import {tinyPhotos} from './app_program.mjs';
import {DESKTOP} from './browser.mjs';

const run = (program, ...args) => execFileSync(program, args, {stdio: ['ignore', 'ignore', 'inherit']});

// The same files as a zip, and as a video of one second.
function packed(photos, folder) {
  const media = join(folder, 'media');
  mkdirSync(media, {recursive: true});
  for (const {name, bytes} of photos) writeFileSync(join(media, name), bytes);
  const [zip, video] = ['walk.zip', 'walk.mp4'].map((name) => join(folder, name));
  run('python3', '-m', 'zipfile', '-c', zip, media);
  run('ffmpeg', '-v', 'error', '-y', '-framerate', '12', '-i', join(media, '%03d.png'), '-pix_fmt', 'yuv420p', video);
  return {
    zip: {name: 'walk.zip', type: 'application/zip', bytes: readFileSync(zip)},
    video: {name: 'walk.mp4', type: 'video/mp4', bytes: readFileSync(video)}};
}

// A run of what is shown comes as far as looking for where the photos were taken: it has found them.
async function findsPhotos(page, id) {
  await page.getByRole('radio', {name: /^Draft/}).check();
  await page.getByRole('button', {name: 'Make the splat'}).click();
  for (;;) {
    const {state, message, stages} = await projectOf(page, id);
    assert.ok(['waiting', 'running', 'finished'].includes(state), `${state}: ${message}`);
    if (stages.find(({label}) => label === 'Finding where each photo was taken')?.state !== 'todo' && stages.length > 0) break;
    await page.waitForTimeout(200);
  }
  const stop = page.getByRole('button', {name: 'Stop'});
  if (await stop.isVisible()) await stop.click();
  await stateIs(page, 'stopped', 'finished', 'new');
}

export async function media(browser, {app, photos, folder}) {
  const {page, problems, close} = await openApp(browser, DESKTOP, app);
  const {zip, video} = packed(photos, folder);
  for (const file of [zip, video]) {
    const id = await begin(page, [file]);
    await stored(page, 1);
    const [kept] = (await projectOf(page, id)).files;
    assert.deepEqual([kept.name, kept.bytes], [file.name, file.bytes.length]);
    await page.locator('h1').getByText('walk', {exact: true}).waitFor();  // it is called as the file
    await findsPhotos(page, id);
    await remove(page, id);
  }
  await close();
  assert.deepEqual(beside(problems, /\b(404|409)\b/), []);
}

// A browser that cannot show HEIC says so, and the photo is taken all the same.
export async function heic(browser, {app, photos, folder}) {
  const {page, problems, close} = await openApp(browser, DESKTOP, app);
  const [from, to] = ['phone.png', 'IMG_0001.HEIC'].map((name) => join(folder, name));
  writeFileSync(from, photos[0].bytes);
  run('heif-enc', from, '-o', to);
  const id = await begin(page, [{name: 'IMG_0001.HEIC', type: '', bytes: readFileSync(to)}, ...photos.slice(1, 3)]);
  await stored(page, 3);
  const tile = page.locator('.photo', {hasText: 'IMG_0001.HEIC'});
  await tile.getByText('Your browser cannot show this kind of photo. OracleGS can read it.').waitFor();
  await page.waitForFunction(async (path) => (await (await fetch(path, {cache: 'no-store'})).json()).check.state === 'done', `api/projects/${id}`);
  const {files, check, can} = await projectOf(page, id);
  const {id: file, kind} = files.find(({name}) => name === 'IMG_0001.HEIC');
  assert.equal(kind, 'photo');
  assert.ok(!check.warnings.some(({files: of}) => of?.includes(file)), JSON.stringify(check));
  assert.ok(can.includes('start'));
  await remove(page, id);
  await close();
  assert.deepEqual(beside(problems, /\b(404|409)\b/), []);
}

// More than a project holds: the page says how many it takes, answers meanwhile, and shows some of them.
export async function tenThousand(browser, {app}) {
  const {page, problems, close} = await openApp(browser, DESKTOP, app);
  const transfer = await page.evaluateHandle((base64) => {
    const data = new DataTransfer();
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    for (let i = 0; i < 10010; i++) data.items.add(new File([bytes], `tiny_${i}.png`, {type: 'image/png'}));
    return data;
  }, Buffer.from(tinyPhotos(1)[0].bytes).toString('base64'));
  for (const kind of ['dragenter', 'dragover', 'drop']) await page.dispatchEvent('body', kind, {dataTransfer: transfer});
  await page.getByText('A splat takes at most 10,000 files. Only the first 10,000 of these are taken.').waitFor();
  await page.waitForFunction(() => document.querySelectorAll('.photo[data-state=stored]').length >= 20);
  const id = await page.evaluate(() => location.hash.slice(4));
  await page.getByLabel('Name').fill('Ten thousand');
  await page.getByRole('radio', {name: /^Draft/}).check();
  assert.equal(await page.locator('.photo').count(), 500);
  await page.getByRole('button', {name: 'Show 500 more of 9,500 files'}).click();
  await page.getByRole('button', {name: 'Show 500 more of 9,000 files'}).waitFor();
  assert.equal(await page.locator('.photo').count(), 1000);
  await page.locator('h1', {hasText: 'Ten thousand'}).waitFor();
  await remove(page, id);
  await close();
  assert.deepEqual(beside(problems, /\b(404|409)\b/), []);
}

// The disk is full after some photos: each other one says so and can be sent again; what was there stays. library: a file that makes
// a disk look full (tests/faults/full_disk.cpp).
export async function fullDisk(browser, {program, photos, folder, start, library, screenshot}) {
  const own = join(folder, 'small disk');
  mkdirSync(own);
  const state = join(own, 'state');
  const room = (bytes) => {
    const numbers = Buffer.alloc(8);
    numbers.writeBigUInt64LE(BigInt(bytes));
    const file = openSync(state, 'r+');  // in place: the program looks at it
    writeSync(file, numbers, 0, 8, 8);
    closeSync(file);
  };
  writeFileSync(state, Buffer.alloc(16));
  room(photos.slice(0, 5).reduce((sum, {bytes}) => sum + bytes.length, 0));
  mkdirSync(join(own, 'library'));
  const app = await start(program, own, 0, {LD_PRELOAD: library, FULL_DISK_FOLDER: join(realpathSync(own), 'library'), FULL_DISK_STATE: state});
  const {page, problems, close} = await openApp(browser, DESKTOP, app);
  const id = await begin(page, photos);
  await page.waitForFunction(() => document.querySelectorAll('.photo[data-state=failed]').length > 0 && !document.querySelector('.photo:is([data-state=queued], [data-state=sending])'));
  const failed = await page.locator('.photo[data-state=failed]').count();
  const there = (await projectOf(page, id)).files.length;
  assert.ok(there > 0 && failed > 1 && there + failed === photos.length, `${there} are there, ${failed} are not`);
  assert.match(await page.locator('.photo[data-state=failed] .photo-reasons').first().textContent(), /the disk is full/);
  await page.locator('.photo-summary', {hasText: `${failed} files could not be taken`}).waitFor();
  room(1e12);
  await page.getByRole('button', {name: 'Try all of them again'}).click();
  await stored(page, photos.length);
  const kept = (await projectOf(page, id)).files;
  assert.deepEqual(kept.map(({name, bytes}) => [name, bytes]), photos.map(({name, bytes}) => [name, bytes.length]), 'whole, and each once');
  await waits();
  await close();
  await app.end();
  assert.deepEqual(beside(problems, /\b(404|409|507)\b/), []);

  // One that waits for its turn while the disk fills is not started again and again: it says why, and goes on with room.
  async function waits() {
    const go = async () => {
      await page.getByRole('radio', {name: /^Draft/}).check();
      await page.getByRole('button', {name: 'Make the splat'}).click();
    };
    await go();
    await stateIs(page, 'running');
    await page.goto(`${app.origin}/#/`);
    const second = await begin(page, photos.slice(0, 4));
    await stored(page, 4);
    await go();
    await stateIs(page, 'waiting');
    room(0);
    await stateIs(page, 'failed');
    await page.locator('.failure', {hasText: 'The disk is full. Make room there, then press “Try again”.'}).waitFor();
    await page.goto(`${app.origin}/#/p/${id}`);
    await stateIs(page, 'failed', 'stopped');
    await screenshot(page, 'app_full_disk');
    room(1e12);
    await remove(page, id);
    await page.goto(`${app.origin}/#/p/${second}`);
    await page.getByRole('button', {name: 'Try again'}).click();
    await stateIs(page, 'running');
    await page.getByRole('button', {name: 'Stop'}).click();
    await stateIs(page, 'stopped', 'failed');
    await remove(page, second);
  }
}
