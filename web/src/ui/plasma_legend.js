// Legend of a confidence map's colors.
import {h} from '../shared/dom.js';

export const plasmaLegend = () => h('div', {class: 'plasma', role: 'img', 'aria-label': 'Confidence: purple is 0, no trust; yellow is 1, trust'},
  h('span', {}, '0 ignored'), h('span', {class: 'plasma-bar'}), h('span', {}, '1 trusted'));
