// What axe-core objects to in a page, as lines. Frames are looked at by themselves.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';

const require = createRequire(new URL('../../web/package.json', import.meta.url));
const axe = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');

export async function objections(page, what) {
  await page.evaluate(axe);  // through the debugger, which the page's policy does not bind
  const {violations, passes} = await page.evaluate(() => globalThis.axe.run(document, {iframes: false}));
  assert.ok(passes.length > 15, `${what}: axe has looked at the page`);
  return violations.map(({id, help, nodes}) =>
    `${what}: ${id}: ${help}\n  ${nodes.map((node) => `${node.html.slice(0, 160)} ${node.any[0]?.message ?? ''}`).join('\n  ')}`);
}
