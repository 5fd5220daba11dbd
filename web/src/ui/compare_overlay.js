// An image of a view over the 3D view, with a slider between the two. It fits while the camera stands at the view's pose.
import {h, uniqueId, fill} from '../shared/dom.js';
import {imagesOf, ROLES} from '../shared/roles.js';

export class CompareOverlay {
  // container: the element of the scene; resolve(url): where the page gets it; onClose(): the user has closed it.
  constructor(container, scene, resolve, onClose) {
    Object.assign(this, {scene, resolve});
    this.picture = h('img', {class: 'compare-image', alt: ''});
    this.line = h('div', {class: 'compare-line'});
    this.layer = h('div', {class: 'compare-layer', hidden: true}, this.picture, this.line);
    this.slider = h('input', {
      type: 'range', min: '0', max: '100', value: '50', class: 'compare-slider',
      'aria-label': 'Image to the left, 3D view to the right', oninput: () => this.cut()});
    this.choices = h('div', {class: 'choices', role: 'radiogroup', 'aria-label': 'Image to compare with'});
    this.caption = h('span', {class: 'compare-name'});
    this.bar = h('div', {class: 'compare-bar', hidden: true},
      h('div', {class: 'compare-row'}, this.caption, this.choices,
        h('button', {type: 'button', class: 'plain', 'aria-label': 'Close the comparison', onclick: () => onClose()}, '×')),
      this.slider);
    container.append(this.layer, this.bar);
    new ResizeObserver(() => this.place()).observe(container);
  }

  get visible() {
    return !this.layer.hidden;
  }

  show(view) {
    const images = imagesOf(view);
    this.view = view;
    this.caption.textContent = `${ROLES[view.role]?.name ?? ''} ${view.name}`;
    const group = uniqueId('compare');
    fill(this.choices, images.map((image, i) => h('label', {},
      h('input', {type: 'radio', name: group, checked: i === 0, onchange: () => this.choose(image)}), h('span', {}, image.label))));
    this.choices.hidden = images.length < 2;
    if (images.length === 0) {
      this.hide();
      return;
    }
    this.choose(images[0]);
    this.layer.hidden = this.bar.hidden = false;
    this.place();
    this.cut();
  }

  choose(image) {
    this.picture.src = this.resolve(image.url);
    this.picture.alt = `${image.label} of ${this.view.name}`;
  }

  hide() {
    this.layer.hidden = this.bar.hidden = true;
  }

  place() {
    if (!this.visible) return;
    const {left, top, width, height} = this.scene.imageRect();
    Object.assign(this.layer.style, {left: `${left}px`, top: `${top}px`, width: `${width}px`, height: `${height}px`});
  }

  // The image shows to the left of the slider's value.
  cut() {
    const value = Number(this.slider.value);
    this.picture.style.clipPath = `inset(0 ${100 - value}% 0 0)`;
    this.line.style.left = `${value}%`;
    this.line.hidden = value === 0 || value === 100;
  }
}
