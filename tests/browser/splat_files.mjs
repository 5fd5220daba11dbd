// The scene's Gaussians as .splat and .spz, in their order.
import {gzipSync} from 'node:zlib';

const byte = (v) => Math.max(0, Math.min(255, Math.round(v)));

export function encodeSplat(gaussians) {
  const out = Buffer.alloc(32 * gaussians.length);
  gaussians.forEach(({position, scale, opacity, color}, i) => {
    position.forEach((v, k) => out.writeFloatLE(v, 32 * i + 4 * k));
    for (let k = 0; k < 3; k++) out.writeFloatLE(scale, 32 * i + 12 + 4 * k);
    out.set([...color.map((c) => byte(255 * c)), byte(255 * opacity), 255, 128, 128, 128], 32 * i + 24);
  });
  return out;
}

// `scales` of a Gaussian are those of its axes, in place of its `scale`.
// Version 2, without spherical harmonics: 24-bit positions with 12 bits after the point, y up and z backward.
export function encodeSpz(gaussians) {
  const n = gaussians.length;
  const header = Buffer.alloc(16);
  header.write('NGSP', 0, 'latin1');
  header.writeUInt32LE(2, 4);
  header.writeUInt32LE(n, 8);
  header.set([0, 12, 0, 0], 12);
  const positions = Buffer.alloc(9 * n);
  gaussians.forEach((g, i) => g.position.forEach((v, k) => positions.writeIntLE(Math.round((k === 0 ? v : -v) * 4096), 9 * i + 3 * k, 3)));
  const alphas = Buffer.from(gaussians.map((g) => byte(255 * g.opacity)));
  const shOf = (c) => (c - 0.5) / 0.28209479177387814;
  const colors = Buffer.from(gaussians.flatMap((g) => g.color.map((c) => byte(255 * (shOf(c) * 0.15 + 0.5)))));
  const scales = Buffer.from(gaussians.flatMap((g) => (g.scales ?? Array(3).fill(g.scale)).map((s) => byte((Math.log(s) + 10) * 16))));
  const rotations = Buffer.alloc(3 * n, 128);
  return gzipSync(Buffer.concat([header, positions, alphas, colors, scales, rotations]));
}
