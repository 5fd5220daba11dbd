// The scale from two places in the 3D view and the length between them.
import {h} from '../shared/dom.js';
import {short} from '../shared/format.js';
import {button, setText} from './parts.js';

export class Measure {
  // focus(): what the 3D view turns around; use(scale)
  constructor(focus, use) {
    Object.assign(this, {focus, use, ends: [null, null]});
    this.state = h('p', {class: 'note', role: 'status'});
    this.length = h('input', {type: 'number', min: '0', step: 'any', 'aria-label': 'Length between them in meters', onchange: () => this.apply()});
    const end = (i, label) => button(label, () => this.mark(i));
    this.element = h('details', {class: 'measure'}, h('summary', {}, 'By a length that you know'), h('div', {class: 'stack'},
      h('p', {class: 'note'}, 'Double-click one end of a thing in the 3D view and press the first button; then the other end and the second button. Then say how long it is.'),
      h('div', {class: 'row'}, end(0, 'This is one end'), end(1, 'This is the other end')),
      h('label', {class: 'field'}, h('span', {}, 'Length in meters'), this.length), this.state));
  }

  mark(i) {
    const focus = this.focus();
    if (focus) this.ends[i] = focus.point;
    setText(this.state, focus ? '' : 'The 3D view is not there yet.');
    if (focus) this.apply();
  }

  get distance() {
    const [a, b] = this.ends;
    return a && b ? Math.hypot(...a.map((v, k) => v - b[k])) : 0;
  }

  apply() {
    const {distance} = this;
    const length = Number(this.length.value);
    if (!this.ends[0] || !this.ends[1]) setText(this.state, `${this.ends[0] ? 'One' : this.ends[1] ? 'The other' : 'No'} end is marked.`);
    else if (!(distance > 0)) setText(this.state, 'Both ends are the same place. Double-click another one.');
    else if (!(length > 0)) setText(this.state, `The ends are ${short(distance)} units apart. How long is that in meters?`);
    else {
      setText(this.state, `${short(distance)} units are ${short(length)} m.`);
      this.use(length / distance);
    }
  }
}
