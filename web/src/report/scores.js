// How good the test views are, and what the run cost.
import {h} from '../shared/dom.js';
import {bytes, duration, number, percent} from '../shared/format.js';
import {table} from './table.js';

const SCORES = [
  ['psnr', 'PSNR', 2, 'dB'], ['psnr_color_corrected', 'PSNR, color-corrected', 2, 'dB'], ['ssim', 'SSIM', 3, ''], ['lpips', 'LPIPS', 3, ''],
  ['psnr_mean_exposure', 'PSNR, mean exposure', 2, 'dB']];

export function scores(run) {
  const views = (run.views ?? []).filter((view) => view.role === 'test' && SCORES.some(([key]) => Number.isFinite(view[key])));
  const means = SCORES.filter(([key]) => Number.isFinite(run.scores?.[key]));
  if (views.length === 0 && means.length === 0) return null;
  const columns = SCORES.filter(([key]) => views.some((view) => Number.isFinite(view[key])));
  return h('div', {},
    h('p', {class: 'lead'}, 'Measured on photos that were held out of training. Higher PSNR and SSIM are better, lower LPIPS is better.',
      run.mean_exposure && ' The splat has the mean exposure of the photos; a view is scored in that of the photos near it.'),
    figures(means.map(([key, name, digits, unit]) => [number(run.scores[key], digits), unit, name])),
    views.length > 0 && h('div', {class: 'card'}, table(views, [
      {name: 'View', value: (view) => view.name},
      ...columns.map(([key, name, digits, unit]) => ({
        name: unit ? `${name} (${unit})` : name, number: true, value: (view) => view[key], cell: (view) => number(view[key], digits)})),
    ], {caption: 'Scores of each test view', sortable: true})));
}

export function figures(list) {
  if (list.length === 0) return null;
  return h('div', {class: 'figures card'}, list.map(([value, unit, name]) =>
    h('div', {}, h('div', {class: 'figure-value'}, value, unit && h('small', {}, ` ${unit}`)), h('div', {class: 'figure-name'}, name))));
}

export function stages(run) {
  const list = run.stages ?? [];
  if (list.length === 0) return null;
  const total = list.reduce((sum, stage) => sum + (stage.seconds ?? 0), 0);
  const bar = (share) => {
    const inner = h('i');
    inner.style.width = `${100 * share}%`;
    return h('div', {class: 'share-bar', 'aria-hidden': 'true'}, inner);
  };
  const rows = list.map((stage) => ({...stage, share: (stage.seconds ?? 0) / (total || 1)}));
  const facts = [`${duration(total)} in all`, run.device && `on ${run.device}`, run.memory_bytes && `${bytes(run.memory_bytes)} of memory at most`];
  return h('div', {}, h('p', {class: 'lead'}, facts.filter(Boolean).join(' · ')), h('div', {class: 'card'}, table(rows, [
    {name: 'Stage', value: (s) => s.name},
    {name: 'Time', number: true, value: (s) => s.seconds, cell: (s) => duration(s.seconds)},
    {name: 'Share', number: true, value: (s) => s.share, cell: (s) => h('div', {class: 'bar-cell'}, bar(s.share), h('span', {}, percent(s.share)))},
  ], {caption: 'Time of each stage', sortable: true})));
}
