// How to photograph, in words and drawings.
import {h, svg} from '../shared/dom.js';

const drawing = (...parts) => svg('svg', {viewBox: '0 0 120 80', class: 'drawing', 'aria-hidden': 'true', focusable: 'false'}, parts);
const rect = (x, y, width, height, kind, rx = 2) => svg('rect', {x, y, width, height, rx, class: kind});
const circle = (cx, cy, r, kind) => svg('circle', {cx, cy, r, class: kind});
const path = (d, kind) => svg('path', {d, class: kind});

// A camera at an angle (degrees, 0 = to the right) around (60, 40), looking at it.
const camera = (angle, radiusX = 46, radiusY = 30) => {
  const x = 60 + radiusX * Math.cos((angle * Math.PI) / 180);
  const y = 40 + radiusY * Math.sin((angle * Math.PI) / 180);
  const turn = (Math.atan2(40 - y, 60 - x) * 180) / Math.PI;
  return svg('g', {transform: `translate(${x.toFixed(1)} ${y.toFixed(1)}) rotate(${turn.toFixed(0)})`},
    path('M-5-4h6v8h-6z', 'ink'), path('M1 0l5-3v6z', 'ink'));
};

const vase = (x, y, kind) => path(`M${x - 7} ${y + 14}c-4-9-4-13 2-17v-7h10v7c6 4 6 8 2 17z`, kind);

const aroundIt = () => drawing(svg('ellipse', {cx: 60, cy: 40, rx: 46, ry: 30, class: 'dashes'}), vase(60, 40, 'thing'),
  [0, 45, 90, 135, 180, 225, 270, 315].map((angle) => camera(angle)));

const overlap = () => drawing(path('M8 62h104', 'line'), vase(30, 48, 'thing'), vase(60, 48, 'thing'), vase(90, 48, 'thing'),
  rect(10, 16, 56, 50, 'frame'), rect(32, 20, 56, 50, 'frame second'), rect(54, 12, 56, 50, 'frame'));

const sharp = () => drawing(rect(6, 12, 50, 52, 'frame'), vase(31, 38, 'thing'), path('M24 72l5 5 9-10', 'good'),
  rect(64, 12, 50, 52, 'frame'), [-5, -2.5, 0, 2.5, 5].map((dx) => vase(89 + dx, 38, 'ghost')), path('M84 69l9 9m0-9l-9 9', 'bad'));

const exposure = () => drawing(
  [[4, 'shade-1'], [43, 'shade-1'], [82, 'shade-3']].map(([x, shade]) => [rect(x, 16, 34, 42, `frame ${shade}`), vase(x + 17, 36, 'thing')]),
  path('M36 66l5 5 9-10', 'good'), path('M94 63l9 9m0-9l-9 9', 'bad'));

const count = () => drawing([0, 1, 2, 3, 4, 5].flatMap((i) => [0, 1].map((j) => rect(8 + 18 * i, 14 + 28 * j, 15, 20, 'frame'))),
  svg('text', {x: 60, y: 76, class: 'label', 'text-anchor': 'middle'}, '12 – 24'));

const RULES = [
  [aroundIt, 'Walk around it', 'Take a photo, take a step, take the next. All the way around if you can; for a room, along the walls. Turning on the spot does not help.'],
  [overlap, 'Let photos overlap', 'Two photos after each other should share more than half of what they show.'],
  [sharp, 'Keep it sharp', 'Hold still, use enough light. A blurred photo does more harm than none.'],
  [exposure, 'Keep the light', 'Same lamps, same brightness, no flash. Nothing should move while you walk; avoid glass and mirrors.'],
  [count, '12 to 24 photos', 'A few more from other heights are good. More than 100 take long and rarely help.'],
];

export function howTo() {
  return h('section', {class: 'how-to', 'aria-labelledby': 'how-to'}, h('h2', {id: 'how-to'}, 'How to photograph'),
    h('ol', {class: 'rules'}, RULES.map(([draw, title, text]) => h('li', {}, draw(), h('h3', {}, title), h('p', {class: 'note'}, text)))));
}
