// Bundles the pages: node web/build.mjs FOLDER writes viewer, report and app, each as .html, .js and .css, there.
import {build} from 'esbuild';
import {copyFile, mkdir, readFile, writeFile} from 'node:fs/promises';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';
import {gzipSync} from 'node:zlib';

const here = dirname(fileURLToPath(import.meta.url));
const source = join(here, 'src');
const out = resolve(process.argv[2] ?? 'dist');

// The licenses of the packages want their notices in every copy.
async function notices(...packages) {
  const texts = packages.map(async (name) => `${name}\n\n${(await readFile(join(here, 'node_modules', name, 'LICENSE'), 'utf8')).trim()}`);
  return {js: `/*\n${(await Promise.all(texts)).join('\n\n----\n\n')}\n*/`};
}
const banner = await notices('three', '@sparkjsdev/spark', 'fflate', 'uplot');

const shared = {bundle: true, minify: true, write: false, charset: 'utf8', target: 'es2022', legalComments: 'none', logLevel: 'warning'};

async function bundle(entry, options) {
  const result = await build({...shared, entryPoints: [join(source, entry)], ...options});
  return result.outputFiles[0].text;
}

// In the report the 3D part (three.js, Spark and its WebAssembly) is a compressed text that is unpacked when it is asked
// for: a third of the bytes, and the page itself starts at once.
const packedScene = {
  name: 'packed-scene',
  setup(context) {
    context.onResolve({filter: /^packed:scene$/}, () => ({path: 'scene', namespace: 'packed'}));
    context.onLoad({filter: /.*/, namespace: 'packed'}, async () => {
      const code = await bundle('scene/packed_entry.js', {format: 'iife'});
      return {contents: gzipSync(code, {level: 9}).toString('base64'), loader: 'text'};
    });
  },
};

// A script inside HTML must hold nothing that opens or ends a script element.
function checkInline(name, text) {
  if (/<\/(script|style)|<!--/i.test(text)) throw new Error(`${name} cannot be part of an HTML page: it holds a tag`);
}

await mkdir(out, {recursive: true});
const [viewer, report, app] = await Promise.all([
  bundle('viewer/main.js', {format: 'esm', banner}),
  bundle('report/main.js', {format: 'iife', banner, plugins: [packedScene]}),
  bundle('app/main.js', {format: 'esm'}),
]);
const [viewerStyle, reportStyle, appStyle] = await Promise.all(
  ['viewer/viewer.css', 'report/report.css', 'app/app.css'].map((entry) => bundle(entry, {})));
checkInline('report.js', report);
checkInline('report.css', reportStyle);
await Promise.all([
  writeFile(join(out, 'viewer.js'), viewer),
  writeFile(join(out, 'viewer.css'), viewerStyle),
  writeFile(join(out, 'report.js'), report),
  writeFile(join(out, 'report.css'), reportStyle),
  writeFile(join(out, 'app.js'), app),
  writeFile(join(out, 'app.css'), appStyle),
  copyFile(join(source, 'app/app.html'), join(out, 'app.html')),
  copyFile(join(source, 'viewer/viewer.html'), join(out, 'viewer.html')),
  copyFile(join(source, 'report/report.html'), join(out, 'report.html')),
]);
