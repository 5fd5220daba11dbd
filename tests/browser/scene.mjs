// A small scene of round Gaussians with known renders: four balls on a chequered floor, one ball a class of support.
// World: y down. Everything is computed, nothing is stored.

const BALLS = [
  {center: [-0.9, -0.45, 0.1], color: [0.85, 0.25, 0.2], support: 0.9},
  {center: [0.9, -0.45, 0.1], color: [0.25, 0.7, 0.3], support: 0.6},
  {center: [0, -0.45, 0.9], color: [0.85, 0.8, 0.75], support: 0.4},
  {center: [0, -0.45, -0.8], color: [0.45, 0.4, 0.85], support: 0.1},
];
export const SIZE = {width: 200, height: 150};
export const BACKGROUND = [13, 15, 18];

// [{position, scale, opacity, color, support}]: scale is the standard deviation.
export function makeGaussians() {
  const out = [];
  for (const {center, color, support} of BALLS) {
    for (let i = 0; i < 450; i++) {  // Fibonacci's sphere
      const y = 1 - (2 * (i + 0.5)) / 450;
      const angle = i * Math.PI * (3 - Math.sqrt(5));
      const r = Math.sqrt(1 - y * y);
      const normal = [r * Math.cos(angle), y, r * Math.sin(angle)];
      const light = 0.65 - 0.35 * normal[1];
      out.push({position: center.map((c, k) => c + 0.42 * normal[k]), scale: 0.028, opacity: 0.95, color: color.map((c) => c * light), support});
    }
  }
  for (let i = 0; i < 30; i++) {
    for (let j = 0; j < 30; j++) {
      const dark = (Math.floor(i / 3) + Math.floor(j / 3)) % 2;
      out.push({position: [(i - 14.5) * 0.133, 0, (j - 14.5) * 0.133], scale: 0.05, opacity: 0.95, color: dark ? [0.25, 0.27, 0.3] : [0.7, 0.7, 0.68], support: 0.95});
    }
  }
  return out;
}

// Three sides of a cube of edge 1, each of flat Gaussians: {gaussians, sides: [{center, normal}]}. makeCamera(-0.7) sees them.
export function makeSides() {
  const middle = [0, -0.3, 0];
  const sides = [[-1, 0, 0], [0, -1, 0], [0, 0, -1]].map((normal) => ({normal, center: middle.map((v, k) => v + 0.5 * normal[k])}));
  const gaussians = sides.flatMap(({normal, center}) => {
    const [right, up] = [0, 1, 2].filter((k) => !normal[k]);
    const scales = normal.map((v) => (v ? 0.004 : 0.05));
    return Array.from({length: 144}, (_, i) => {
      const position = [...center];
      position[right] += (i % 12 - 5.5) / 12;
      position[up] += (Math.floor(i / 12) - 5.5) / 12;
      return {position, scales, opacity: 0.95, color: [0.5, 0.5, 0.5], support: 0.9};
    });
  });
  return {gaussians, sides};
}

export const ballCenter = (i) => BALLS[i].center;

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const unit = (a) => a.map((v) => v / Math.hypot(...a));

// A camera at an angle around the scene, rolled about its axis; world_to_camera as in the run document.
export function makeCamera(angle, height = 1.5, roll = 0) {
  const from = [3.4 * Math.sin(angle), -height, -3.4 * Math.cos(angle)];
  const forward = unit(from.map((v, k) => [0, -0.3, 0][k] - v));
  const level = unit(cross([0, 1, 0], forward));
  const down = cross(forward, level);
  const right = level.map((v, k) => v * Math.cos(roll) + down[k] * Math.sin(roll));
  const rolled = cross(forward, right);
  const rows = [right, rolled, forward].map((axis) => [...axis, -dot(axis, from)]);
  return {...SIZE, fx: 190, fy: 190, cx: SIZE.width / 2, cy: SIZE.height / 2 - 6, world_to_camera: [...rows.flat(), 0, 0, 0, 1]};
}

export function project(camera, p) {
  const m = camera.world_to_camera;
  const [x, y, z] = [0, 4, 8].map((r) => m[r] * p[0] + m[r + 1] * p[1] + m[r + 2] * p[2] + m[r + 3]);
  return {x: (camera.fx * x) / z + camera.cx, y: (camera.fy * y) / z + camera.cy, z, cx: x, cy: y};
}

// The reference image: round Gaussians, projected with the local affine approximation, 0.3 px^2 added, blended near to far.
export function render(gaussians, camera) {
  const {width, height, fx, fy} = camera;
  const color = new Float64Array(width * height * 3);
  const left = new Float64Array(width * height).fill(1);
  const seen = gaussians.map((g) => ({g, p: project(camera, g.position)})).filter(({p}) => p.z > 0.1).sort((a, b) => a.p.z - b.p.z);
  for (const {g, p} of seen) {
    const v = g.scale ** 2;
    const [jx, jy, kx, ky] = [fx / p.z, fy / p.z, (-fx * p.cx) / p.z ** 2, (-fy * p.cy) / p.z ** 2];
    const [a, b, c] = [v * (jx * jx + kx * kx) + 0.3, v * kx * ky, v * (jy * jy + ky * ky) + 0.3];
    const det = a * c - b * b;
    const reach = 3.2 * Math.sqrt(Math.max(a, c));
    for (let y = Math.max(0, Math.floor(p.y - reach)); y < Math.min(height, p.y + reach); y++) {
      for (let x = Math.max(0, Math.floor(p.x - reach)); x < Math.min(width, p.x + reach); x++) {
        const [dx, dy] = [x + 0.5 - p.x, y + 0.5 - p.y];
        const alpha = Math.min(0.99, g.opacity * Math.exp((-0.5 * (c * dx * dx - 2 * b * dx * dy + a * dy * dy)) / det));
        if (alpha < 1 / 255) continue;
        const at = y * width + x;
        for (let k = 0; k < 3; k++) color[3 * at + k] += left[at] * alpha * g.color[k];
        left[at] *= 1 - alpha;
      }
    }
  }
  const rgb = new Uint8Array(width * height * 3);
  for (let i = 0; i < rgb.length; i++) rgb[i] = Math.round(Math.min(255, 255 * color[i] + left[Math.floor(i / 3)] * BACKGROUND[i % 3]));
  return {width, height, rgb};
}
