// 8-bit RGB PNGs, written and read with Node's zlib alone.
import {crc32Table} from './crc32.mjs';
import {deflateSync, inflateSync} from 'node:zlib';

function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = crc32Table[(crc ^ byte) & 255] ^ (crc >>> 8);
  return (crc ^ 0xffffffff) >>> 0;
}

function chunk(type, body) {
  const out = Buffer.alloc(12 + body.length);
  out.writeUInt32BE(body.length, 0);
  out.write(type, 4, 'latin1');
  body.copy(out, 8);
  out.writeUInt32BE(crc32(out.subarray(4, 8 + body.length)), 8 + body.length);
  return out;
}

// rgb: width * height * 3 bytes, rows top to bottom.
export function encodePng({width, height, rgb}) {
  const header = Buffer.from([0, 0, 0, 0, 0, 0, 0, 0, 8, 2, 0, 0, 0]);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  const rows = Buffer.alloc(height * (1 + 3 * width));
  for (let y = 0; y < height; y++) Buffer.from(rgb.buffer, rgb.byteOffset + 3 * width * y, 3 * width).copy(rows, y * (1 + 3 * width) + 1);
  const signature = Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]);
  return Buffer.concat([signature, chunk('IHDR', header), chunk('IDAT', deflateSync(rows)), chunk('IEND', Buffer.alloc(0))]);
}

// Reads a browser's screenshot: RGB or RGBA, not interlaced. Alpha is dropped.
export function decodePng(bytes) {
  let at = 8;
  let width, height, channels;
  const packed = [];
  while (at < bytes.length) {
    const length = bytes.readUInt32BE(at);
    const type = bytes.toString('latin1', at + 4, at + 8);
    const body = bytes.subarray(at + 8, at + 8 + length);
    if (type === 'IHDR') [width, height, channels] = [body.readUInt32BE(0), body.readUInt32BE(4), body[9] === 6 ? 4 : 3];
    if (type === 'IDAT') packed.push(body);
    at += 12 + length;
  }
  const raw = inflateSync(Buffer.concat(packed));
  const stride = width * channels;
  const rows = new Uint8Array(height * stride);
  for (let y = 0; y < height; y++) unfilter(raw, rows, y, stride, channels);
  const rgb = new Uint8Array(width * height * 3);
  for (let i = 0; i < width * height; i++) for (let k = 0; k < 3; k++) rgb[3 * i + k] = rows[channels * i + k];
  return {width, height, rgb};
}

function unfilter(raw, rows, y, stride, channels) {
  const filter = raw[y * (stride + 1)];
  for (let i = 0; i < stride; i++) {
    const left = i >= channels ? rows[y * stride + i - channels] : 0;
    const above = y > 0 ? rows[(y - 1) * stride + i] : 0;
    const corner = y > 0 && i >= channels ? rows[(y - 1) * stride + i - channels] : 0;
    const guess = [0, left, above, (left + above) >> 1, paeth(left, above, corner)][filter];
    rows[y * stride + i] = raw[y * (stride + 1) + 1 + i] + guess;
  }
}

function paeth(a, b, c) {
  const p = a + b - c;
  const [pa, pb, pc] = [Math.abs(p - a), Math.abs(p - b), Math.abs(p - c)];
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}

// Peak signal-to-noise ratio of two images of the same size, in dB.
export function psnr(a, b) {
  let sum = 0;
  for (let i = 0; i < a.rgb.length; i++) sum += (a.rgb[i] - b.rgb[i]) ** 2;
  return 10 * Math.log10((255 * 255 * a.rgb.length) / Math.max(sum, 1e-9));
}
