// A group of radio buttons under a name.
import {h, uniqueId} from '../shared/dom.js';

export class Choices {
  // options: [{id, label, note}]; onChange(id)
  constructor(legend, options, onChange, {stacked = false} = {}) {
    const name = uniqueId('choice');
    this.notes = new Map();
    this.inputs = options.map(({id, label, note}) => {
      const input = h('input', {type: 'radio', name, value: id, onchange: () => onChange?.(id)});
      this.notes.set(id, h('span', {class: 'choice-note'}, note ?? ''));
      return [input, label];
    });
    this.element = h('fieldset', {class: stacked ? 'pick stacked' : 'pick'}, h('legend', {}, legend),
      h('div', {class: 'pick-row'}, this.inputs.map(([input, label]) =>
        h('label', {}, input, h('span', {class: 'choice-label'}, label), this.notes.get(input.value)))));
  }

  get value() {
    return this.inputs.find(([input]) => input.checked)?.[0].value;
  }

  set value(id) {
    for (const [input] of this.inputs) input.checked = input.value === String(id);
  }

  note(id, text) {
    const element = this.notes.get(id);
    if (element && element.textContent !== text) element.textContent = text;
  }
}
