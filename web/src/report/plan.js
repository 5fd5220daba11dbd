// Cameras and points from above: points on a canvas, cameras as SVG with their names.
import {bytesOf} from '../shared/bytes.js';
import {h, svg} from '../shared/dom.js';
import {ROLES} from '../shared/roles.js';

const WIDTH = 1600;
const HEIGHT = 1000;

export function plan(run) {
  const views = (run.views ?? []).filter((view) => view.camera?.world_to_camera?.length === 16);
  if (views.length === 0) return null;
  const cameras = views.map(cameraOf);
  const place = run.place ?? run.splat;
  const axes = planAxes(place?.up, cameras);
  const flat = (p) => [dot(p, axes.right), dot(p, axes.ahead)];
  const canvas = h('canvas', {width: WIDTH, height: HEIGHT, 'aria-hidden': 'true'});
  const overlay = svg('svg', {viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: 'img', 'aria-label': describe(views)});
  const spots = cameras.map((c) => flat(c.position));
  if (place?.center) spots.push(...around(flat(place.center), (place.radius ?? 0) * 0.9));
  const fit = fitting(spots);
  const length = 0.035 * WIDTH;
  cameras.forEach((camera, i) => overlay.append(wedge(views[i], fit(flat(camera.position)), direction(flat(camera.forward)), length)));
  if (run.points?.url) bytesOf(run.points.url).then((bytes) => drawPoints(canvas, bytes, flat, fit)).catch(() => {});
  return h('div', {}, h('div', {class: 'plan'}, canvas, overlay), legend(views));
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((v) => v / (Math.hypot(...a) || 1));
const around = ([x, y], r) => [[x - r, y - r], [x + r, y + r]];
const direction = ([x, y]) => unit([x, -y, 0]).slice(0, 2);

function cameraOf({camera}) {
  const m = camera.world_to_camera;
  const position = [0, 1, 2].map((k) => -(m[k] * m[3] + m[4 + k] * m[7] + m[8 + k] * m[11]));
  return {position, forward: [m[8], m[9], m[10]], up: [-m[4], -m[5], -m[6]]};
}

// Two directions in the ground plane; the first camera looks upwards on the page.
function planAxes(given, cameras) {
  const mean = [0, 1, 2].map((k) => cameras.reduce((sum, c) => sum + c.up[k], 0));
  const up = unit(given ?? mean);
  const level = (v) => v.map((value, k) => value - dot(v, up) * up[k]);
  let ahead = level(cameras[0].forward);
  if (Math.hypot(...ahead) < 0.05) ahead = level(Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0]);
  ahead = unit(ahead);
  return {ahead, right: cross(ahead, up)};
}

// From plan coordinates to pixels: everything given is inside, with a margin.
function fitting(spots) {
  const xs = spots.map((p) => p[0]);
  const ys = spots.map((p) => p[1]);
  const [minX, maxX, minY, maxY] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const scale = 0.82 * Math.min(WIDTH / Math.max(maxX - minX, 1e-9), HEIGHT / Math.max(maxY - minY, 1e-9));
  return ([x, y]) => [WIDTH / 2 + (x - (minX + maxX) / 2) * scale, HEIGHT / 2 - (y - (minY + maxY) / 2) * scale];
}

function wedge(view, [x, y], [dx, dy], length) {
  const half = view.camera.width / (2 * view.camera.fx);
  const corner = (side) => [x + length * (dx - side * half * dy), y + length * (dy + side * half * dx)].map((v) => v.toFixed(1)).join(',');
  const {color} = ROLES[view.role] ?? ROLES.train;
  return svg('g', {}, svg('title', {}, view.name),
    svg('polygon', {points: `${x.toFixed(1)},${y.toFixed(1)} ${corner(-1)} ${corner(1)}`, fill: color, 'fill-opacity': '0.3', stroke: color, 'stroke-width': '2.5', 'stroke-linejoin': 'round'}),
    svg('circle', {cx: x, cy: y, r: '5', fill: color}));
}

function drawPoints(canvas, buffer, flat, fit) {
  const view = new DataView(buffer);
  const context = canvas.getContext('2d');
  for (let at = 0; at + 15 <= buffer.byteLength; at += 15) {
    const [x, y] = fit(flat([0, 4, 8].map((k) => view.getFloat32(at + k, true))));
    context.fillStyle = `rgb(${view.getUint8(at + 12)} ${view.getUint8(at + 13)} ${view.getUint8(at + 14)} / 0.8)`;
    context.fillRect(x - 1.5, y - 1.5, 3, 3);
  }
}

function legend(views) {
  return h('div', {class: 'plan-legend'}, Object.entries(ROLES).map(([role, {plural, color}]) => {
    const count = views.filter((view) => view.role === role).length;
    if (count === 0) return null;
    const dot = h('i', {class: 'dot', 'aria-hidden': 'true'});
    dot.style.background = color;
    return h('span', {}, dot, `${plural} (${count})`);
  }));
}

const describe = (views) => `Plan from above with ${Object.entries(ROLES)
  .map(([role, {plural}]) => [plural.toLowerCase(), views.filter((view) => view.role === role).length]).filter(([, n]) => n)
  .map(([name, n]) => `${n} ${name}`).join(', ')}`;
