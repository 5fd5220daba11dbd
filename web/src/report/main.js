// The report of a run: one page without requests. A section appears where the document has what it shows.
import {h, put} from '../shared/dom.js';
import {explorer} from './explorer.js';
import {film, hero, warnings} from './hero.js';
import {comparisons, proposals} from './images.js';
import {calibration, certainty, curves, support} from './measures.js';
import {plan} from './plan.js';
import {commandAndOptions, licenses} from './record.js';
import {poses} from './poses.js';
import {next, registration} from './registration.js';
import {scores, stages} from './scores.js';

const run = JSON.parse(document.getElementById('document').textContent);
document.title = `${run.title ?? 'OracleGS'} – report`;

const SECTIONS = [
  ['splat', '3D', 'The splat in 3D', explorer],
  ['film', 'Film', 'The film', film],
  ['photos', 'Photos', 'The splat beside the photos', comparisons],
  ['next', 'Next photos', 'What to photograph next', next],
  ['scores', 'Scores', 'Scores', scores],
  ['proposals', 'Invented views', 'Invented views, and how sure the program is', proposals],
  ['certainty', 'Certainty', 'How sure the splat is of itself', certainty],
  ['support', 'Support', 'How well photos support the splat', support],
  ['calibration', 'Trust', 'Is the trust deserved?', calibration],
  ['plan', 'Cameras', 'Cameras and points from above', plan],
  ['registration', 'Registration', 'Registration of the photos', registration],
  ['poses', 'Poses', 'Poses of the photos', poses],
  ['training', 'Training', 'Training', curves],
  ['stages', 'Stages', 'Stages', stages],
  ['reproduce', 'Options', 'Command and options', commandAndOptions],
  ['licenses', 'Licenses', 'Licenses', licenses],
];

const sections = SECTIONS.map(([id, short, title, make]) => ({id, short, title, content: make(run)})).filter((s) => s.content);

put(document.getElementById('page'),
  hero(run),
  sections.length > 1 && h('nav', {class: 'contents', 'aria-label': 'Contents'},
    h('ul', {}, sections.map((s) => h('li', {}, h('a', {href: `#${s.id}`}, s.short))))),
  h('main', {id: 'main', tabIndex: -1}, warnings(run),
    sections.map((s) => h('section', {id: s.id, 'aria-labelledby': `${s.id}-title`}, h('h2', {id: `${s.id}-title`}, s.title), s.content))),
  h('footer', {}, [run.program, run.created && new Date(run.created).toLocaleString('en', {dateStyle: 'long', timeStyle: 'short'})].filter(Boolean).join(' · ')));
