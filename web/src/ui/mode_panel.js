// What the 3D view shows, with the legend of that, and what to hide.
import {MODES} from '../shared/modes.js';
import {h, fill, uniqueId} from '../shared/dom.js';
import {number, percent, short} from '../shared/format.js';
import {ramp, swatch} from './swatches.js';

export class ModePanel {
  // onChange(id of a mode, hideBelow: a support in [0,1])
  constructor(onChange) {
    this.onChange = onChange;
    this.mode = MODES[0];
    const group = uniqueId('mode');
    this.boxes = new Map(MODES.map((mode) => [mode, h('input', {
      type: 'radio', name: group, checked: mode === this.mode, onchange: () => this.choose(mode)})]));
    this.labels = new Map(MODES.map((mode) => [mode, h('label', {}, this.boxes.get(mode), h('span', {}, mode.name))]));
    this.note = h('p', {class: 'note'});
    this.legend = h('ul', {class: 'legend'});
    this.ramp = h('div', {class: 'ramp'});
    this.hide = h('input', {
      type: 'range', min: '0', max: '1', step: '0.01', value: '0', 'aria-label': 'Hide Gaussians with support below', oninput: () => this.changed()});
    this.value = h('output', {}, '0.00');
    this.hideRow = h('label', {class: 'range-row'}, h('span', {}, 'Hide support below ', this.value), this.hide);
    this.element = h('section', {class: 'panel modes', hidden: true, 'aria-label': 'What the 3D view shows'},
      h('h2', {id: group}, 'Show'), h('div', {class: 'choices', role: 'radiogroup', 'aria-labelledby': group}, [...this.labels.values()]),
      this.note, this.legend, this.ramp, this.hideRow);
  }

  // known: what the splat has, {support, uncertainty}; counts: Gaussians a class of support, or nothing.
  setKnown(known, counts) {
    this.element.hidden = false;
    Object.assign(this, {known, counts});
    for (const [mode, label] of this.labels) label.hidden = !this.can(mode);
    this.hideRow.hidden = !counts;
    if (this.can(this.mode)) this.describe();
    else this.choose(MODES[0]);
  }

  can(mode) {
    return !mode.needs || Boolean(this.known?.[mode.needs]);
  }

  // Shows a mode, or true colors when it is shown already.
  toggle(id) {
    const mode = MODES.find((m) => m.id === id);
    if (this.can(mode)) this.choose(mode === this.mode ? MODES[0] : mode);
  }

  next() {
    const able = MODES.filter((mode) => this.can(mode));
    this.choose(able[(able.indexOf(this.mode) + 1) % able.length]);
  }

  choose(mode) {
    this.mode = mode;
    this.boxes.get(mode).checked = true;
    this.describe();
    this.changed();
  }

  changed() {
    this.value.textContent = Number(this.hide.value).toFixed(2);
    this.onChange(this.mode.id, Number(this.hide.value));
  }

  // The distances at the ends of a ramp that has no texts there.
  setRange(range) {
    this.range = range;
    const ends = this.mode.ends ?? (range && [short(range.far), short(range.near)]);
    fill(this.ramp, this.mode.ramp && ends && ramp(this.mode.ramp, ...ends));
  }

  describe() {
    const {note, swatches, id} = this.mode;
    const total = id === 'provenance' ? this.counts?.reduce((a, b) => a + b, 0) : 0;
    this.note.textContent = note;
    this.note.hidden = !note;
    this.legend.hidden = !swatches;
    this.ramp.hidden = !this.mode.ramp;
    fill(this.legend, swatches?.map(({name, color}, i) => h('li', {}, swatch(color), h('span', {class: 'legend-name'}, name),
      total > 0 && h('span', {class: 'legend-value', title: `${number(this.counts[i])} Gaussians`}, percent(this.counts[i] / total, 1)))));
    this.setRange(this.range);
  }
}
