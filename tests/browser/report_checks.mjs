// A report opened from a file: everything that its document has is there, without a request.
import assert from 'node:assert/strict';
import {pathToFileURL} from 'node:url';
import {DESKTOP, NARROW, openPage} from './browser.mjs';
import * as checks from './scene_checks.mjs';

const MAX_LOAD_MS = 3000;

async function open(browser, file, size) {
  const url = pathToFileURL(file).href;
  const opened = await openPage(browser, size, url);
  await opened.page.goto(url);
  const run = JSON.parse(await opened.page.locator('#document').textContent());
  return {...opened, run};
}

// bound: PSNR of the 3D view against the program's render, dB.
export async function desktop(browser, {file, bound, screenshot}) {
  const {page, problems, close, run} = await open(browser, file, DESKTOP);
  const milliseconds = await page.evaluate(() => performance.getEntriesByType('navigation')[0].loadEventEnd);
  console.log(`     ${file} opens in ${(milliseconds / 1000).toFixed(2)} s (at most ${MAX_LOAD_MS / 1000} s are wanted)`);
  await screenshot(page, 'report');
  await showsTheHero(page);
  await hasItsSections(page, run);
  await showsItsImages(page);
  const tests = run.views?.filter((view) => view.role === 'test' && view.render && view.image) ?? [];
  if (tests.length > 0) await comparesTestViews(page, tests);
  await sortsTables(page);
  await checks.tabsThrough(page, 5);
  await checks.followsTheScheme(page);
  if (run.splat?.url) await showsTheSplat(page, {run, bound, screenshot});
  assert.deepEqual(problems, []);
  await close();
}

export async function narrow(browser, {file, screenshot}) {
  const {page, problems, close, run} = await open(browser, file, {...NARROW, colorScheme: 'dark'});
  await checks.fitsTheWidth(page);
  await showsTheHero(page);
  await screenshot(page, 'report_phone', true);
  if (run.splat?.url) {
    await page.getByRole('button', {name: 'Show in 3D'}).tap();
    await page.locator('.stage[data-drawn]').waitFor();
    await checks.fitsTheWidth(page);
  }
  assert.deepEqual(problems, []);
  await close();
}

// The whole image is on the first screen, and no text lies over it.
async function showsTheHero(page) {
  const image = page.locator('.hero > img');
  if (!(await image.count())) return;
  await image.evaluate((element) => element.decode());
  const [box, text, fit] = [await image.boundingBox(), await page.locator('.hero-text').boundingBox(), await image.evaluate((element) => getComputedStyle(element).objectFit)];
  const window = page.viewportSize();
  assert.ok(box.x >= 0 && box.y >= 0 && box.x + box.width <= window.width && box.y + box.height <= window.height, JSON.stringify(box));
  assert.ok(text.y >= box.y + box.height - 1, 'its text is below');
  assert.equal(fit, 'contain');
}

async function hasItsSections(page, run) {
  const has = (role, ...keys) => run.views?.some((view) => view.role === role && keys.every((key) => view[key]));
  const expected = {
    splat: run.splat?.url, scores: run.scores?.psnr, photos: has('test', 'render', 'image') || has('train', 'render', 'image'), film: run.video?.url,
    next: run.registration?.advice?.length, proposals: has('proposal', 'image'),
    support: run.support?.classes?.length, calibration: run.calibration?.bins?.length, plan: run.views?.length,
    registration: run.registration?.views?.length, training: run.curves?.length, stages: run.stages?.length, reproduce: run.command,
    licenses: run.licenses?.length};
  for (const [id, wanted] of Object.entries(expected)) {
    assert.equal(await page.locator(`section#${id}`).count(), wanted ? 1 : 0, `section ${id}`);
  }
  assert.equal(await page.locator('h1').count(), 1);
  if (run.title) assert.equal(await page.locator('h1').textContent(), run.title);
  assert.equal(await page.locator('.warnings b').count(), 0, 'texts are no markup');
}

async function showsItsImages(page) {
  const broken = await page.evaluate(async () => {
    const images = [...document.images];
    for (const image of images) {
      image.loading = 'eager';
      await image.decode().catch(() => {});
    }
    return images.filter((image) => image.naturalWidth === 0 || !image.hasAttribute('alt')).map((image) => image.alt);
  });
  assert.deepEqual(broken, [], 'all images can be decoded and have a text');
}

async function comparesTestViews(page, tests) {
  const sliders = page.locator('#photos .slider-range');
  assert.equal(await sliders.count(), tests.length);
  const cut = () => page.locator('#photos .slider-top').first().evaluate((image) => image.style.clipPath);
  await sliders.first().focus();
  await page.keyboard.press('Home');
  assert.match(await cut(), /100%/);
  await page.keyboard.press('PageUp');
  assert.doesNotMatch(await cut(), /100%/);
  const bottom = page.locator('#photos .slider-frame img:not(.slider-top)').first();
  const shown = [await bottom.getAttribute('src')];
  for (const name of ['Error', 'Expected error', 'Support']) {
    const map = page.locator('#photos .slider').first().getByRole('radio', {name, exact: true});
    if (!(await map.count())) continue;
    await map.check();
    const source = await bottom.getAttribute('src');
    assert.ok(!shown.includes(source), `${name} takes the place of the photo`);
    shown.push(source);
  }
}

async function sortsTables(page) {
  const head = page.locator('#scores th button').nth(1);
  if (!(await head.count())) return;
  const column = () => page.locator('#scores tbody tr td:nth-child(2)').evaluateAll((cells) => cells.map((cell) => Number(cell.textContent)));
  await head.click();
  assert.deepEqual(await column(), [...(await column())].sort((a, b) => a - b));
  await head.click();
  assert.deepEqual(await column(), [...(await column())].sort((a, b) => b - a));
}

async function showsTheSplat(page, {run, bound, screenshot}) {
  await page.getByRole('button', {name: 'Show in 3D'}).click();
  await page.locator('.stage[data-drawn]').waitFor();
  const goTo = async (view) => {
    await page.getByLabel('Go to a view').selectOption(String(view.id));
    await page.waitForFunction((id) => globalThis.oraclegs.scene.current?.id === id, view.id);
    await page.locator('.stage canvas').focus();
  };
  await page.locator('.stage').scrollIntoViewIfNeeded();
  await page.locator('.stage').evaluate((stage) => scrollTo(0, stage.getBoundingClientRect().top + scrollY - 80));
  if (run.views?.some((view) => view.render?.url)) await checks.showsTheRender(page, {run, resolve: (url) => url, bound, goTo});
  if (run.splat.support) await checks.tintsAndHides(page, {range: page.getByLabel('Hide Gaussians with support below')});
  if (run.views?.length) {
    await checks.clicksAFrustum(page);
    await checks.comparesBySlider(page);
    await checks.changesTheLens(page, {run, goTo});
    await checks.suggestsPhotos(page, run);
  }
  await checks.savesAnImage(page, {run, save: () => page.getByRole('button', {name: 'Save image'}).click()});
  await screenshot(page, 'report_3d');
}
