// The switch and the legend of the provenance mode, and what to hide.
import {CLASSES} from '../shared/support_classes.js';
import {h, fill} from '../shared/dom.js';
import {number, percent} from '../shared/format.js';

export class ProvenancePanel {
  // onChange(tint, hideBelow): tint is a boolean, hideBelow a support in [0,1].
  constructor(onChange) {
    this.tint = h('input', {type: 'checkbox', class: 'switch', onchange: () => this.changed(onChange)});
    this.range = h('input', {
      type: 'range', min: '0', max: '1', step: '0.01', value: '0', 'aria-label': 'Hide Gaussians with support below',
      oninput: () => this.changed(onChange)});
    this.value = h('output', {}, '0.00');
    this.legend = h('ul', {class: 'legend'});
    this.element = h('section', {class: 'panel provenance', hidden: true, 'aria-label': 'Provenance'},
      h('label', {class: 'switch-row'}, h('span', {}, h('strong', {}, 'Provenance'), ' ', h('kbd', {}, 'P')), this.tint),
      h('p', {class: 'note'}, 'How well photos show each Gaussian.'),
      this.legend,
      h('label', {class: 'range-row'}, h('span', {}, 'Hide support below ', this.value), this.range));
    this.fillLegend();
  }

  // counts: Gaussians a class, or nothing when the splat has no support.
  setCounts(counts) {
    this.element.hidden = !counts;
    if (counts) this.fillLegend(counts);
  }

  fillLegend(counts) {
    const total = counts?.reduce((a, b) => a + b, 0);
    fill(this.legend, CLASSES.map((c, i) => {
      const swatch = h('span', {class: 'swatch', 'aria-hidden': 'true'});
      swatch.style.background = c.color;
      return h('li', {}, swatch, h('span', {class: 'legend-name'}, c.name),
        total > 0 && h('span', {class: 'legend-value', title: `${number(counts[i])} Gaussians`}, percent(counts[i] / total, 1)));
    }));
  }

  toggle() {
    if (!this.element.hidden) this.tint.click();
  }

  changed(onChange) {
    this.value.textContent = Number(this.range.value).toFixed(2);
    onChange(this.tint.checked, Number(this.range.value));
  }
}
