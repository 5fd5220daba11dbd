// Pixels of the 3D view.
import {decodePng} from './png.mjs';

// Waits until the 3D view has drawn everything that it was asked for.
export async function settled(page) {
  await page.evaluate(() => new Promise((done) => {
    const {scene} = globalThis.oraclegs;
    scene.addEventListener('drawn', () => done(), {once: true});
    scene.stage.invalidate();
  }));
}

// The part of the 3D view where the image of its camera is, as {width, height, rgb} of that size.
export async function shownImage(page, width, height) {
  const box = await page.evaluate(() => {
    const rect = globalThis.oraclegs.scene.imageRect();
    const canvas = globalThis.oraclegs.scene.canvas.getBoundingClientRect();
    return {x: canvas.x + rect.left, y: canvas.y + rect.top, width: rect.width, height: rect.height};
  });
  const clip = {x: Math.floor(box.x), y: Math.floor(box.y), width: Math.ceil(box.width) + 2, height: Math.ceil(box.height) + 2};
  const shot = decodePng(await page.screenshot({clip}));
  const scale = await page.evaluate(() => window.devicePixelRatio);
  const part = {x: (box.x - clip.x) * scale, y: (box.y - clip.y) * scale, width: box.width * scale, height: box.height * scale};
  return resized(shot, part, width, height);
}

// A part of an image, which may lie between pixels, in another size: the mean of 3 x 3 samples a pixel.
export function resized(image, part, w, h) {
  const out = new Uint8Array(w * h * 3);
  for (let y = 0; y < h; y++) {
    for (let x = 0; x < w; x++) {
      const sum = [0, 0, 0];
      for (let i = 0; i < 9; i++) {
        const u = part.x + ((x + ((i % 3) + 0.5) / 3) * part.width) / w;
        const v = part.y + ((y + (Math.floor(i / 3) + 0.5) / 3) * part.height) / h;
        for (let k = 0; k < 3; k++) sum[k] += between(image, u - 0.5, v - 0.5, k);
      }
      for (let k = 0; k < 3; k++) out[3 * (y * w + x) + k] = Math.round(sum[k] / 9);
    }
  }
  return {width: w, height: h, rgb: out};
}

// Bilinear; outside, the border goes on.
function between({width, height, rgb}, x, y, k) {
  const at = (u, v) => rgb[3 * (Math.min(Math.max(v, 0), height - 1) * width + Math.min(Math.max(u, 0), width - 1)) + k];
  const [u, v] = [Math.floor(x), Math.floor(y)];
  const [a, b] = [x - u, y - v];
  return (at(u, v) * (1 - a) + at(u + 1, v) * a) * (1 - b) + (at(u, v + 1) * (1 - a) + at(u + 1, v + 1) * a) * b;
}

// An image as the browser decodes it, at most `limit` pixels wide.
export async function decodeInPage(page, url, limit = 320) {
  const {width, height, rgba} = await page.evaluate(async ([source, most]) => {
    const image = new Image();
    image.src = source;
    await image.decode();
    const canvas = document.createElement('canvas');
    const scale = Math.min(1, most / image.naturalWidth);
    [canvas.width, canvas.height] = [Math.round(image.naturalWidth * scale), Math.round(image.naturalHeight * scale)];
    const context = canvas.getContext('2d');
    context.imageSmoothingQuality = 'high';
    context.drawImage(image, 0, 0, canvas.width, canvas.height);
    return {width: canvas.width, height: canvas.height, rgba: Array.from(context.getImageData(0, 0, canvas.width, canvas.height).data)};
  }, [url, limit]);
  return {width, height, rgb: Uint8Array.from({length: width * height * 3}, (_, i) => rgba[4 * Math.floor(i / 3) + (i % 3)])};
}

// The mean over the image of how far two images differ, 0 to 255.
export function difference(a, b) {
  let sum = 0;
  for (let i = 0; i < a.rgb.length; i++) sum += Math.abs(a.rgb[i] - b.rgb[i]);
  return sum / a.rgb.length;
}

export const pixel = ({width, rgb}, x, y) => {
  const at = 3 * (Math.round(y) * width + Math.round(x));
  return [rgb[at], rgb[at + 1], rgb[at + 2]];
};
