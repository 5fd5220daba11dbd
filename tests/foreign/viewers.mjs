// Draws files of one splat with Spark and with three.js in headless Chromium, and prints how alike the pictures are to given ones:
//   node viewers.mjs JOB, a JSON file of {width, height, fov, files: [PATH], not_read: ['VIEWER FILE'], poses: [{matrix, image}]}
// matrix: camera-to-world of the .ply with OpenGL's camera axes; image: a PNG. Prints {"three .glb": {psnr: [dB, ...], alike: [dB, ...]}}:
// to the images, and to the same viewer's picture of the .ply, the first of the files.
import {readFileSync, writeFileSync} from 'node:fs';
import {readFile} from 'node:fs/promises';
import {createServer} from 'node:http';
import {basename, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {launch} from '../browser/browser.mjs';
import {decodePng} from '../browser/png.mjs';

const FOLDER = fileURLToPath(new URL('.', import.meta.url));
const ENGINES = {spark: ['.ply', '.compressed.ply', '.spz', '.sog', '.splat'], three: ['.ply', '.spz', '.glb', '.splat']};  // and what each reads
// Signs of the axes that a file has, against those of a .ply (docs/formats.md).
const AXES = {'.spz': [1, -1, -1], '.glb': [-1, -1, 1]};
const IMPORTS = {
  three: '/modules/three/build/three.module.js', 'three/webgpu': '/modules/three/build/three.webgpu.js', 'three/tsl': '/modules/three/build/three.tsl.js',
  'three/addons/': '/modules/three/examples/jsm/', spark: '/modules/@sparkjsdev/spark/dist/spark.module.js'};
const PAGE = `<!doctype html><link rel="icon" href="data:,"><script type="importmap">${JSON.stringify({imports: IMPORTS})}</script><script type="module" src="/viewers_page.js"></script>`;

const {width, height, fov, files, not_read: notRead, poses} = JSON.parse(readFileSync(process.argv[2]));
const endingOf = (file) => (file.endsWith('.compressed.ply') ? '.compressed.ply' : file.slice(file.lastIndexOf('.')));

const served = new Map(files.map((file) => [`/files/${basename(file)}`, file]));
const server = createServer(async (request, response) => {
  const {pathname} = new URL(request.url, 'http://localhost');
  const from = served.get(pathname) ?? join(FOLDER, pathname.startsWith('/modules/') ? pathname.replace('modules', 'node_modules') : 'viewers_page.js');
  response.setHeader('Content-Type', pathname === '/' ? 'text/html' : pathname.endsWith('.js') ? 'text/javascript' : 'application/octet-stream');
  try {
    response.end(pathname === '/' ? PAGE : await readFile(from));
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise((ready) => server.listen(0, '127.0.0.1', ready));

function psnr(a, b) {
  const sum = a.reduce((total, value, i) => total + (value - b[i]) ** 2, 0);
  return sum === 0 ? Infinity : 10 * Math.log10((255 * 255 * a.length) / sum);
}

const mirrored = (matrix, signs) => matrix.map((row, r) => row.map((x) => x * (signs[r] ?? 1)));

// The pictures of all poses, as bytes.
async function drawn(browser, engine, file) {
  const page = await browser.newPage({viewport: {width, height}});
  page.setDefaultTimeout(120000);
  page.on('pageerror', (error) => {
    console.error(`${engine} ${file}: ${error.message}`);
    process.exit(1);
  });
  await page.goto(`http://127.0.0.1:${server.address().port}/?${new URLSearchParams({engine, file: `/files/${basename(file)}`, width, height})}`);
  await page.waitForFunction(() => globalThis.ready);
  const pictures = [];
  for (const [i, {matrix}] of poses.entries()) {
    const address = await page.evaluate(([rows, angle]) => globalThis.draw(rows, angle), [mirrored(matrix, AXES[endingOf(file)] ?? []), fov]);
    const png = Buffer.from(address.split(',')[1], 'base64');
    writeFileSync(`${file}.${engine}.${i}.png`, png);
    pictures.push(decodePng(png).rgb);
  }
  await page.close();
  return pictures;
}

const truths = poses.map(({image}) => decodePng(readFileSync(image)).rgb);
const browser = await launch();
const scores = {};
for (const [engine, endings] of Object.entries(ENGINES)) {
  let first;
  for (const file of files.filter((name) => endings.includes(endingOf(name)) && !notRead.includes(`${engine} ${basename(name)}`))) {
    const pictures = await drawn(browser, engine, file);
    first ??= pictures;
    scores[`${engine} ${basename(file)}`] = {psnr: pictures.map((picture, i) => psnr(picture, truths[i])), alike: pictures.map((picture, i) => Math.min(99, psnr(picture, first[i])))};
  }
}
await browser.close();
server.close();
console.log(JSON.stringify(scores));
