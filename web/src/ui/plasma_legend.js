// Legend of the colors of a map of trust.
import {h} from '../shared/dom.js';
import {ramp} from './swatches.js';

const PLASMA = ['#0d0887', '#46039f', '#7201a8', '#9c179e', '#bd3786', '#d8576b', '#ed7953', '#fb9f3a', '#fdca26', '#f0f921'];

export const plasmaLegend = () => h('div', {class: 'ramp', role: 'img', 'aria-label': 'Trust: purple is 0, none; yellow is 1, full'},
  ramp(PLASMA, '0 ignored', '1 trusted'));
