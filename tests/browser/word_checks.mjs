// A photographer reads the pages: the paper's words stand only where commands and options are named.
import assert from 'node:assert/strict';
import {pathToFileURL} from 'node:url';
import {DESKTOP, openPage} from './browser.mjs';
import {startServer} from './server.mjs';

const PAPER = /prox(y|ies)|\bpropos\w*|\bconfiden\w*|(weakly )?supported\b|\boracle\b/i;

async function wordsOf(page) {
  return page.evaluate(() => {
    const copy = document.body.cloneNode(true);
    for (const element of copy.querySelectorAll('script, #reproduce')) element.remove();
    const hidden = [...copy.querySelectorAll('*')].flatMap((element) => ['aria-label', 'title', 'alt'].map((name) => element.getAttribute(name)));
    return [copy.textContent, ...hidden].filter(Boolean);
  });
}

export async function plainWords(browser, {assets, run, file}) {
  const server = await startServer(assets, {document: run.document, live: null, files: run.files});
  const viewer = await openPage(browser, DESKTOP, server.url);
  await viewer.page.goto(server.url);
  await viewer.page.locator('.stage[data-drawn]').waitFor();
  await viewer.page.locator('#view-7').click();
  await viewer.page.locator('.compare-layer').waitFor({state: 'visible'});
  await viewer.page.keyboard.press('p');
  const report = await openPage(browser, DESKTOP, pathToFileURL(file).href);
  await report.page.goto(pathToFileURL(file).href);
  for (const {page, close} of [viewer, report]) {
    const texts = await wordsOf(page);
    for (const text of texts) assert.doesNotMatch(text, PAPER);
    for (const word of ['Invented view', 'Trust', 'well seen', 'seen by one photo', 'invented and trusted', 'weak']) {
      assert.ok(texts.some((text) => text.includes(word)), `${word} is said`);
    }
    await close();
  }
  await server.close();
}
