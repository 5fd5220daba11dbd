// Checks of the 3D view of both pages, for any run: it shows what the program rendered, provenance, frusta.
import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {decodeInPage, difference, settled, shownImage} from './picture.mjs';
import {decodePng, psnr} from './png.mjs';

// goTo(view): chooses a view as a user does. resolve(url): where the page finds it.
export async function showsTheRender(page, {run, goTo, resolve, bound}) {
  const view = run.views.find((v) => v.role === 'test' && v.render?.url) ?? run.views.find((v) => v.render?.url);
  assert.ok(view, 'the document has a rendered view');
  const truth = await decodeInPage(page, resolve(view.render.url));
  await goTo(view);
  await page.keyboard.press('Escape');
  await settled(page);
  const shown = await shownImage(page, truth.width, truth.height);
  const value = psnr(shown, truth);
  console.log(`     the 3D view at ${view.name} has ${value.toFixed(1)} dB against its render (at least ${bound} dB are needed)`);
  assert.ok(value >= bound, `PSNR ${value}`);
}

// Provenance by the key P: other colors, and nothing left when everything is hidden.
export async function tintsAndHides(page, {range}) {
  await page.locator('.stage canvas').focus();
  await settled(page);
  const before = await shownImage(page, 160, 120);
  await page.keyboard.press('p');
  await settled(page);
  const tinted = await shownImage(page, 160, 120);
  assert.ok(difference(before, tinted) > 8, `the tint changes the image: ${difference(before, tinted)}`);
  await range.fill('1');
  await settled(page);
  const hidden = await shownImage(page, 160, 120);
  assert.ok(difference(tinted, hidden) > 8, 'hiding what is below 1 changes the image');
  await range.fill('0');
  await page.locator('.stage canvas').focus();
  await page.keyboard.press('p');
  await settled(page);
  assert.ok(difference(before, await shownImage(page, 160, 120)) < 1, 'the colors come back');
  return tinted;
}

// Flies to each suggested photo, whose text stands there until the camera moves.
export async function suggestsPhotos(page, run) {
  const advice = run.registration?.advice?.filter(({view}) => run.views.some(({id, camera}) => id === view && camera)) ?? [];
  for (const [i, {text, view}] of advice.entries()) {
    await page.getByRole('button', {name: `Suggested photo ${i + 1}`}).click();
    await page.waitForFunction((id) => globalThis.oraclegs.scene.current?.id === id, view);
    const caption = page.locator('.suggestion-caption');
    await caption.waitFor({state: 'visible'});
    assert.equal(await caption.textContent(), text);
    assert.equal(await page.locator('.compare-layer').isVisible(), false, 'the splat alone is seen');
    await page.locator('.stage canvas').focus();
    await page.keyboard.press('ArrowLeft', {delay: 100});
    assert.equal(await caption.isVisible(), false, 'it goes when the camera moves');
  }
}

// The slider changes the angle; a flight brings that of its camera. goTo(view): as in showsTheRender.
export async function changesTheLens(page, {run, goTo}) {
  const angle = () => page.evaluate(() => globalThis.oraclegs.scene.fieldOfView);
  const slider = page.getByLabel('Field of view in degrees');
  const view = run.views.find((v) => v.role === 'train' && v.camera);
  await goTo(view);
  await settled(page);
  const own = await angle();
  assert.equal(Number(await slider.inputValue()), Math.round(own));
  for (const wanted of [120, 30]) {
    await slider.fill(String(wanted));
    await settled(page);
    assert.ok(Math.abs((await angle()) - wanted) < 1e-6, `${wanted} degrees are ${await angle()}`);
    assert.equal(Number(await slider.inputValue()), wanted);
  }
  assert.equal(await page.locator('.compare-layer').isVisible(), false, 'no image fits another lens');
  await goTo(view);
  await settled(page);
  assert.ok(Math.abs((await angle()) - own) < 1e-6, 'the camera has its own lens');
}

// The saved image has the canvas's pixels and shows what it shows.
export async function savesAnImage(page, {run, save}) {
  await settled(page);
  const wanted = page.waitForEvent('download');
  await save();
  const download = await wanted;
  assert.equal(download.suggestedFilename(), `${run.title.replace(/[/\\:*?"<>|]+/g, '_')}.png`);
  const image = decodePng(await readFile(await download.path()));
  const size = await page.evaluate(() => {
    const {width, height} = globalThis.oraclegs.scene.canvas;
    return {width, height};
  });
  assert.deepEqual({width: image.width, height: image.height}, size);
  let bright = 0;
  for (const value of image.rgb) bright += value > 60;
  assert.ok(bright > 0.02 * image.rgb.length, 'it is not empty');
}

// Turns the camera and clicks a frustum that is in sight; the page flies there and shows its image.
export async function clicksAFrustum(page) {
  await page.evaluate(() => {
    const {scene} = globalThis.oraclegs;
    scene.controls.orbit(0, 0.5);
    scene.controls.zoom(2.6);
  });
  await settled(page);
  const target = await page.evaluate(() => {
    const {scene} = globalThis.oraclegs;
    const {width, height} = scene.stage.size;
    for (const view of scene.views) {
      const p = scene.screenPositionOf(view);
      const inside = p.visible && p.x > 30 && p.y > 60 && p.x < width - 30 && p.y < height - 60;
      const box = scene.canvas.getBoundingClientRect();
      const picked = inside && scene.frusta.pick(p.x, p.y, scene.stage.camera, scene.stage.size);
      const top = inside && document.elementFromPoint(box.x + p.x, box.y + p.y);
      if (picked && top === scene.canvas) return {id: picked.id, x: box.x + p.x, y: box.y + p.y};
    }
    return null;
  });
  assert.ok(target, 'a frustum is in sight');
  await page.mouse.click(target.x, target.y);
  await page.waitForFunction((id) => globalThis.oraclegs.scene.current?.id === id, target.id);
  await page.locator('.compare-slider').waitFor({state: 'visible'});
  return target.id;
}

// The slider between image and 3D view, by keys alone.
export async function comparesBySlider(page) {
  const slider = page.locator('.compare-slider');
  const cut = () => page.locator('.compare-image').evaluate((image) => image.style.clipPath);
  await slider.focus();
  await page.keyboard.press('Home');
  assert.match(await cut(), /inset\(0px 100% 0px 0px\)/);
  await page.keyboard.press('End');
  assert.match(await cut(), /inset\(0px 0%? ?0px 0px\)|inset\(0px\)|inset\(0px 0% 0px 0px\)/);
  await slider.fill('50');
  assert.match(await cut(), /50%/);
}

// Tab reaches every control in turn, each shows its focus, and the focus leaves the page again.
export async function tabsThrough(page, atLeast) {
  await page.evaluate(() => document.activeElement?.blur());
  const seen = new Set();
  for (let i = 0; i < 200; i++) {
    await page.keyboard.press('Tab');
    const state = await page.evaluate(() => {
      const element = document.activeElement;
      if (!element || element === document.body) return null;
      globalThis.tabOrder ??= new Map();
      if (!globalThis.tabOrder.has(element)) globalThis.tabOrder.set(element, globalThis.tabOrder.size);
      const outlined = (e) => e && getComputedStyle(e).outlineStyle !== 'none';
      const name = element.getAttribute('aria-label') ?? element.labels?.[0]?.textContent ?? (element.textContent || element.querySelector('img')?.alt) ?? '';
      return {id: globalThis.tabOrder.get(element), what: element.outerHTML.slice(0, 90), name: name.trim(),
              focus: outlined(element) || outlined(element.nextElementSibling) || outlined(element.closest('.slider-frame'))};
    });
    if (!state || seen.has(state.id)) break;
    assert.ok(state.focus, `its focus is visible: ${state.what}`);
    assert.ok(state.name, `it has a name: ${state.what}`);
    seen.add(state.id);
  }
  assert.ok(seen.size >= atLeast, `Tab reaches ${seen.size} controls, at least ${atLeast} are there`);
}

export async function fitsTheWidth(page) {
  const {wide, narrow} = await page.evaluate(() => ({wide: document.documentElement.scrollWidth, narrow: window.innerWidth}));
  assert.ok(wide <= narrow, `the page is ${wide} px wide in a window of ${narrow} px`);
}

// The page follows the system's light or dark.
export async function followsTheScheme(page) {
  const brightness = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).slice(0, 3).reduce((a, b) => a + Number(b), 0) / 3);
  await page.emulateMedia({colorScheme: 'light'});
  const light = await brightness();
  await page.emulateMedia({colorScheme: 'dark'});
  const dark = await brightness();
  await page.emulateMedia({colorScheme: 'light'});
  assert.ok(light > 200 && dark < 60, `light ${light}, dark ${dark}`);
}
