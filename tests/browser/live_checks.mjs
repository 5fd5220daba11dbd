// The page while a run trains, against the tests' own server, whose state the test changes.
import assert from 'node:assert/strict';
import {DESKTOP, openPage} from './browser.mjs';
import {makeLive, makeRun, makeSnapshot} from './fixture.mjs';
import {difference, settled, shownImage} from './picture.mjs';
import {startServer} from './server.mjs';

const SNAPSHOTS = 5;  // that come one after the other, to see that old ones are freed

export async function live(browser, {assets, screenshot}) {
  const final = makeRun();
  const early = {...final.document, splat: null, finished: false};
  const state = {document: null, live: {...makeLive(0), splat: null, document: false, document_revision: 0}, files: new Map(final.files)};
  const server = await startServer(assets, state);
  const {page, problems, close} = await openPage(browser, DESKTOP, server.url);
  const drawn = (part) => page.locator(`.stage[data-drawn*="${part}"]`).waitFor();
  await page.goto(server.url);
  await page.getByText('The program looks for where the photos were taken').waitFor();
  await page.evaluate(() => { globalThis.samePage = true; });

  await showsSnapshots();
  await takesTheFinalSplat();
  await close();
  await server.close();
  assert.deepEqual(problems, []);
  await saysThatTheProgramHasEnded();
  await showsPhotosFirst(browser, assets, screenshot);

  async function showsSnapshots() {
    state.files.set('live/splat.splat', makeSnapshot(final.gaussians, 0));
    state.live = {...makeLive(50), document: false};  // the splat comes before the cameras
    await drawn(' 50 ');
    state.document = early;
    state.live = makeLive(100);
    await drawn(' 100 ');
    const camera = await page.evaluate(() => globalThis.oraclegs.scene.current?.id);
    assert.equal(camera, 0, 'the first camera is the first pose as soon as it is known');
    await page.locator('.run .curves summary').click();
    await page.locator('.run .chart canvas').waitFor();
    assert.match(await page.locator('.stages').textContent(), /100 of 1,000 iterations.*left/);
    const label = await page.locator('.run .chart').getAttribute('aria-label');
    await page.locator('.stage canvas').focus();
    await page.keyboard.press('ArrowLeft', {delay: 200});
    await settled(page);
    const pose = await page.evaluate(() => globalThis.oraclegs.scene.pose.position.toArray());
    const first = await shownImage(page, 160, 120);
    const memory = () => page.evaluate(() => ({...globalThis.oraclegs.scene.stage.renderer.info.memory}));
    let used;
    for (let i = 2; i <= SNAPSHOTS; i++) {
      state.files.set('live/splat.splat', makeSnapshot(final.gaussians, i % 3));
      state.live = makeLive(100 * i);
      await page.evaluate(() => globalThis.oraclegs.session.poll());
      await drawn(` ${100 * i} `);
      if (i === 3) used = await memory();
      if (i === 2) assert.ok(difference(first, await shownImage(page, 160, 120)) > 8, 'the new splat is drawn');
    }
    assert.deepEqual(await memory(), used, 'old splats are freed');
    assert.notEqual(await page.locator('.run .chart').getAttribute('aria-label'), label, 'the curve grows');
    assert.deepEqual(await page.evaluate(() => globalThis.oraclegs.scene.pose.position.toArray()), pose, 'the camera stays');
    assert.equal(await page.evaluate(() => globalThis.samePage), true, 'the page was not loaded again');
    await screenshot(page, 'viewer_live');
  }

  async function takesTheFinalSplat() {
    await asksNothingWhileHidden();
    state.document = final.document;
    state.live = {...makeLive(1000, 'finished'), document_revision: 2};
    await page.evaluate(() => globalThis.oraclegs.session.poll());
    await drawn('final');
    await page.locator('.modes').getByText('provenance').waitFor({state: 'visible'});
    assert.equal(await page.locator('.badge').textContent(), 'Finished');
    for (const [name, text] of [['failed', 'The run failed'], ['interrupted', 'The run was stopped']]) {
      state.live = {...makeLive(1000, name), document_revision: 2};
      await page.evaluate(() => globalThis.oraclegs.session.poll());
      await page.locator('.run').getByText(text).waitFor();
    }
  }

  async function asksNothingWhileHidden() {
    const hide = (hidden) => page.evaluate((value) => {
      Object.defineProperty(document, 'hidden', {value, configurable: true});
      document.dispatchEvent(new Event('visibilitychange'));
    }, hidden);
    await hide(true);
    await page.waitForTimeout(300);
    const before = server.counts.get('/api/live');
    await page.waitForTimeout(2400);
    assert.equal(server.counts.get('/api/live'), before, 'a hidden page asks nothing');
    await hide(false);
    await page.waitForFunction(() => !globalThis.oraclegs.session.polling);
    assert.ok(server.counts.get('/api/live') > before, 'it asks again when it is seen');
  }

  // The connection errors that Chromium logs are what is tested here.
  async function saysThatTheProgramHasEnded() {
    const other = await startServer(assets, {...state, live: makeLive(100)});
    const gone = await openPage(browser, DESKTOP, other.url);
    await gone.page.goto(other.url);
    await gone.page.locator('.stage[data-drawn]').waitFor();
    await other.close();
    await gone.page.getByText('The program has ended; this page stays as it is').waitFor();
    assert.equal(await gone.page.locator('.badge').textContent(), 'Ended');
    assert.ok(gone.problems.every((problem) => problem.includes('ERR_CONNECTION_REFUSED')), gone.problems.join('\n'));
    await gone.close();
  }
}

// Before training: photos without cameras fill the stage; then the cameras and points are there.
async function showsPhotosFirst(browser, assets, screenshot) {
  const {document: run, files, gaussians} = makeRun();
  const photos = run.views.filter((view) => view.role === 'train').map(({camera, ...photo}) => photo);
  const stages = [{name: 'register', state: 'running', seconds: 3, done: 2, total: 4, unit: 'images', detail: '', eta_seconds: 4},
                  {name: 'train', state: 'planned', seconds: 28}];
  const state = {document: {...run, splat: null, place: null, finished: false, views: photos}, files: new Map(files),
                 live: {...makeLive(0), splat: null, curves: [], stages, left_seconds: 80}};
  const server = await startServer(assets, state);
  const {page, problems, close} = await openPage(browser, DESKTOP, server.url);
  await page.goto(server.url);
  await page.locator('.mosaic img').first().waitFor();
  assert.equal(await page.locator('.mosaic img').count(), photos.length);
  await page.getByText('Cameras, points and the splat appear here').waitFor();
  assert.match(await page.locator('.run').textContent(), /about 80 s left.*train, planned.*about 28 s/);
  await page.locator('[role=option]').first().click();  // it has no pose to fly to
  await screenshot(page, 'viewer_photos');
  state.files.set('live/splat.splat', makeSnapshot(gaussians, 0));
  state.document = {...run, splat: null, finished: false};
  state.live = {...state.live, document_revision: 2, splat: {url: 'live/splat.splat', of: 'sparse points', iteration: null, gaussians: 2700}};
  await page.locator('.stage[data-drawn*="sparse points"]').waitFor();
  assert.equal(await page.locator('.mosaic').isVisible(), false);
  assert.match(await page.locator('.facts').textContent(), /sparse points/);
  assert.deepEqual(problems, []);
  await close();
  await server.close();
}
