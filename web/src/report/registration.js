// Which photos have a pose, which have none and why, and where another photo would help.
import {h} from '../shared/dom.js';
import {number} from '../shared/format.js';
import {figures} from './scores.js';
import {table} from './table.js';

export function registration(run) {
  const found = run.registration;
  if (!found || (!found.views?.length && !Number.isFinite(found.photos))) return null;
  const facts = [
    Number.isFinite(found.photos) && [`${found.registered ?? '–'} of ${found.photos}`, '', 'photos have a pose'],
    Number.isFinite(found.reprojection_error) && [number(found.reprojection_error, 2), 'px', 'reprojection error'],
    Number.isFinite(found.parallax_degrees) && [number(found.parallax_degrees, 1), '°', 'parallax']].filter(Boolean);
  const views = found.views ?? [];
  const troubled = views.filter((view) => view.registered === false || view.why || view.advice);
  return h('div', {}, figures(facts),
    (found.warnings ?? []).map((text) => h('p', {class: 'warning'}, text)),
    troubled.length > 0 && h('div', {class: 'card'}, rows(troubled)),
    views.length > troubled.length && h('details', {}, h('summary', {}, `All ${views.length} photos`), h('div', {class: 'card'}, rows(views))),
    found.attempts?.length > 1 && h('details', {}, h('summary', {}, `All ${found.attempts.length} attempts`), h('div', {class: 'card'}, attempts(found.attempts))));
}

// Where another photo would help, each with how the splat looks from there now.
export function next(run) {
  const advice = run.registration?.advice ?? [];
  if (advice.length === 0) return null;
  const byId = new Map((run.views ?? []).map((view) => [view.id, view]));
  return h('div', {class: 'pairs'}, advice.map(({text, view}) => {
    const render = byId.get(view)?.render;
    return h('figure', {}, render?.url && h('img', {src: render.url, alt: 'The splat as it looks from there now', loading: 'lazy', decoding: 'async'}),
      h('figcaption', {class: 'advice'}, text));
  }));
}

const attempts = (list) => table(list, [
  {name: 'Attempt', value: (attempt) => `${attempt.features}, ${attempt.name}`},
  {name: 'Photos', number: true, value: (attempt) => attempt.registered},
  {name: 'Points', number: true, value: (attempt) => attempt.points},
  {name: 'Kept', value: (attempt) => (attempt.kept ? 'yes' : 'no')},
  {name: 'Why', value: (attempt) => attempt.why ?? ''},
], {caption: 'Attempts to find the cameras', sortable: list.length > 3});

const rows = (views) => table(views, [
  {name: 'Photo', value: (view) => view.name},
  {name: 'Verdict', value: (view) => view.status ?? (view.registered ? 'registered' : 'not registered')},
  {name: 'Why', value: (view) => view.why ?? ''},
  {name: 'What to do', value: (view) => view.advice ?? ''},
], {caption: 'Verdict on each photo', sortable: views.length > 3});
