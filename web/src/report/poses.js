// How well each photo's pose fits the others, and how far it was corrected.
import {h} from '../shared/dom.js';
import {number, percent} from '../shared/format.js';
import {figures} from './scores.js';
import {table} from './table.js';

const TEXTS = {
  kept: 'The poses fit the photos: they are kept as they are.',
  refined: 'The poses were off, and were corrected before depth and training.',
  undone: 'The poses are off, and no small correction fixes them: they are kept, and what they show may blur.',
};

export function poses(run) {
  const found = run.poses;
  if (!found || !(found.result in TEXTS)) return null;
  const moved = found.result !== 'kept';
  const columns = [
    {name: 'Photo', value: (view) => view.name},
    {name: 'Off by (px)', number: true, value: (view) => view.before, cell: (view) => number(view.before, 2)}];
  if (moved) {
    columns.push(
      {name: 'Then (px)', number: true, value: (view) => view.after, cell: (view) => number(view.after, 2)},
      {name: 'Turned', number: true, value: (view) => view.degrees, cell: (view) => `${number(view.degrees, 2)}°`},
      {name: 'Moved', number: true, value: (view) => view.share, cell: (view) => percent(view.share, 2)});
  }
  const rows = table(found.views, columns, {caption: 'Fit and correction of each pose', sortable: found.views.length > 3});
  return h('div', {},
    figures([[number(found.before, 2), 'px', 'the given poses are off by'], moved && [number(found.after, 2), 'px', 'after correction']].filter(Boolean)),
    h('p', {}, TEXTS[found.result], moved && ' What is moved is a share of the scene: of the distance of the cameras from their center.'),
    h('details', {open: moved}, h('summary', {}, `All ${found.views.length} photos`), h('div', {class: 'card'}, rows)));
}
