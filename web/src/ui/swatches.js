// Colors of a legend: single ones, and a range between two texts.
import {h} from '../shared/dom.js';

export function swatch(color) {
  const element = h('span', {class: 'swatch', 'aria-hidden': 'true'});
  element.style.background = color;
  return element;
}

export function ramp(colors, low, high) {
  const bar = h('span', {class: 'ramp-bar', 'aria-hidden': 'true'});
  bar.style.background = `linear-gradient(90deg, ${colors.join(', ')})`;
  return [h('span', {}, low), bar, h('span', {}, high)];
}
