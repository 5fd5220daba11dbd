// Curves of the training, support, certainty and calibration.
import {h} from '../shared/dom.js';
import {number, percent} from '../shared/format.js';
import {CLASSES} from '../shared/support_classes.js';
import {Chart} from '../ui/chart.js';
import {swatch} from '../ui/swatches.js';
import {table} from './table.js';

export function curves(run) {
  const list = (run.curves ?? []).filter((curve) => curve.x?.length > 1);
  if (list.length === 0) return null;
  return h('div', {class: 'cards'}, list.map((curve) => h('div', {class: 'card'}, h('h3', {}, curve.name),
    new Chart([curve], {logarithmic: curve.name === 'loss'}).element)));
}

export function support(run) {
  const classes = run.support?.classes ?? [];
  if (classes.length === 0) return null;
  const rows = classes.map((row, i) => ({...row, ...CLASSES[i]}));  // best first in both; a document may have older names
  const column = (key, title, show) => classes.some((c) => Number.isFinite(c[key])) && {name: title, number: true, value: (c) => c[key], cell: (c) => show(c[key])};
  return h('div', {},
    h('p', {class: 'lead'}, 'Support says where a Gaussian comes from: how many photos show it, or whether it was invented.'),
    h('div', {class: 'card'}, table(rows, [
      {name: 'Class', value: (c) => c.name, cell: (c) => h('span', {class: 'class-name'}, swatch(c.color), c.name)},
      column('gaussians', 'Gaussians', (v) => percent(v, 1)), column('share', 'Pixels of test views', (v) => percent(v, 1)),
      column('mean_error', 'Mean error', (v) => number(v, 3))].filter(Boolean), {caption: 'Classes of support'})));
}

export function certainty(run) {
  const parts = [measuredCertainty(run), ...bounds(run)].filter(Boolean);
  return parts.length > 0 && h('div', {}, h('p', {class: 'lead'}, 'Models that learned from the same photos differ where the photos leave something open. How far they differ is the error to expect.'), parts);
}

function measuredCertainty(run) {
  const measured = run.uncertainty?.models ?? run.uncertainty?.gaussians;
  if (!Number.isFinite(measured?.auroc_large_error)) return null;
  const kept = 100 * (1 - measured.ause_ratio);
  return h('p', {class: 'lead'}, `On the test photos, which no model saw, it finds errors above 0.1 with an AUROC of ${number(measured.auroc_large_error, 2)} (0.5 is chance, 1 is perfect), `,
    `and sorting pixels by it gains ${number(kept, 0)} % of what sorting them by their true errors would.`);
}

// What most errors stay below, by photos that a draft had not seen.
function bounds(run) {
  const known = (run.uncertainty?.bound?.classes ?? []).filter((row) => Number.isFinite(row.below));
  if (known.length === 0) return [];
  const {photos} = run.uncertainty.bound;
  const tested = known.some((row) => Number.isFinite(row.pixels));
  const expected = ({from, to}) => to >= 1 ? `from ${number(from, 2)}` : `up to ${number(to, 2)}`;
  return [h('p', {class: 'lead'}, `Drafts that had each learned from a part of the photos were held against the others, ${photos} in all. The result has learned from all of them, so it should err less than this.`),
    h('div', {class: 'card'}, table(known, [
      {name: 'Error to expect', value: (row) => row.from, cell: expected},
      {name: '9 of 10 pixels err less than', number: true, value: (row) => row.below, cell: (row) => number(row.below, 3)},
      ...tested ? [{name: 'Pixels of test views', number: true, value: (row) => row.pixels, cell: (row) => percent(row.pixels, 1)},
                   {name: 'Of those, below it', number: true, value: (row) => row.covered, cell: (row) => percent(row.covered, 1)}] : []],
    {caption: 'What most errors stay below'}))];
}

export function calibration(run) {
  const bins = (run.calibration?.bins ?? []).filter((bin) => Number.isFinite(bin.confidence) && Number.isFinite(bin.share));
  if (bins.length === 0) return null;
  const {title, x_name = 'trust', y_name = 'share of right pixels'} = run.calibration;
  const x = bins.map((bin) => bin.confidence);
  const chart = new Chart([
    {name: y_name, x_name, x, y: bins.map((bin) => bin.share)},
    {name: 'perfect', x_name, x: [0, 1], y: [0, 1], dash: [6, 5]},
  ], {points: true, yName: y_name, range: {x: [0, 1], y: [0, 1]}, height: 300});
  return h('div', {},
    h('p', {class: 'lead'}, title && `${title}. `, 'On the dashed line, pixels with a trust of 0.7 are right 70 % of the time; below it, the program trusts too much.'),
    h('div', {class: 'card'}, chart.element));
}
