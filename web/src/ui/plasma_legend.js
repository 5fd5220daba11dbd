// Legends of the colors of maps of trust and of errors.
import {h} from '../shared/dom.js';
import {PLASMA} from '../shared/plasma.js';
import {ramp} from './swatches.js';

export const plasmaLegend = () => h('div', {class: 'ramp', role: 'img', 'aria-label': 'Trust: purple is 0, none; yellow is 1, full'},
  ramp(PLASMA, '0 ignored', '1 trusted'));

export const errorLegend = () => h('div', {class: 'ramp', role: 'img', 'aria-label': 'Error: purple is none, yellow is 0.3 and more'},
  ramp(PLASMA, 'no error', 'off by 0.3 and more'));
