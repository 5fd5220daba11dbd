// The field of view as a slider. A flight to a camera brings that camera's own.
import {h} from '../shared/dom.js';

export class LensSlider {
  constructor(scene) {
    this.value = h('output', {});
    this.range = h('input', {
      type: 'range', min: '10', max: '120', step: '1', 'aria-label': 'Field of view in degrees',
      oninput: () => scene.setFieldOfView(Number(this.range.value))});
    this.element = h('label', {class: 'range-row'}, h('span', {}, 'Field of view ', this.value), this.range);
    scene.addEventListener('drawn', () => this.show(scene.fieldOfView));
    this.show(scene.fieldOfView);
  }

  show(degrees) {
    this.value.textContent = `${Math.round(degrees)}°`;
    this.range.value = String(Math.round(degrees));
  }
}
