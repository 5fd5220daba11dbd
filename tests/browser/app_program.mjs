// A running `oraclegs app` and the photos that the tests drop.
import {execFileSync, spawn} from 'node:child_process';
import {mkdirSync, readdirSync, readFileSync} from 'node:fs';
import {join} from 'node:path';
import {encodePng} from './png.mjs';
import {makeCamera, makeGaussians, render} from './scene.mjs';

const PHOTOS = 12;

// [{name, type, bytes}] of the demo scene; without a program, of the small scene of these tests.
export function makePhotos(program, folder) {
  if (program) {
    execFileSync(program, ['demo-scene', join(folder, 'demo'), '--demo-views', String(PHOTOS), '--quiet'], {stdio: 'inherit'});
    const images = join(folder, 'demo', 'images');
    return readdirSync(images).sort().map((name) => photo(name, readFileSync(join(images, name))));
  }
  const gaussians = makeGaussians();
  return Array.from({length: PHOTOS}, (_, i) => photo(`photo_${i}.png`, encodePng(render(gaussians, makeCamera(-0.6 + 0.1 * i, 1.4, 0)))));
}

const photo = (name, bytes) => ({name, type: 'image/png', bytes});

// Photos of some pixels, each of another color.
export const tinyPhotos = (count) => Array.from({length: count}, (_, i) => {
  const color = [i & 255, (7 * i) & 255, i >> 3];
  return photo(`tiny_${String(i).padStart(3, '0')}.png`, encodePng({width: 16, height: 12, rgb: Uint8Array.from({length: 16 * 12 * 3}, (_, k) => color[k % 3])}));
});

// {address, origin, port, end(signal)}; address: what it prints, to be opened.
export async function startApp(program, folder, port = 0, env = {}) {
  const library = join(folder, 'library');
  mkdirSync(join(folder, 'data'), {recursive: true});  // where the trash is
  const child = spawn(program, ['app', '--library', library, '--no-browser', '--port', String(port)], {
    stdio: ['ignore', 'pipe', 'inherit'], env: {...process.env, XDG_DATA_HOME: join(folder, 'data'), ...env}});
  const ended = new Promise((done) => child.once('exit', done));
  const address = await new Promise((found, fail) => {
    let text = '';
    child.stdout.on('data', (data) => {
      text += data;
      const line = /^app\s+(http:\/\/\S+)\s/m.exec(text);
      if (line) found(line[1]);
    });
    child.once('exit', (code) => fail(new Error(`the program ended with ${code} before it printed an address: ${text}`)));
    child.once('error', fail);
  });
  const {origin, port: own} = new URL(address);
  const end = (signal = 'SIGTERM') => {
    child.kill(signal);
    return ended;
  };
  return {address, origin, port: Number(own), end, ended};
}
