// Two images of the same size on top of each other, with a slider between them and a choice of what lies on the right.
import {h, uniqueId} from '../shared/dom.js';

// left: {label, url}; right: [{label, url}, ...], the first is shown; name: of the view, for alternative texts.
export function imageSlider({left, right, name, width, height}) {
  const picture = (image) => h('img', {
    src: image.url, alt: `${image.label} of ${name}`, loading: 'lazy', decoding: 'async', width, height, draggable: 'false'});
  const top = picture(left);
  top.className = 'slider-top';
  const bottom = picture(right[0]);
  const line = h('div', {class: 'slider-line', 'aria-hidden': 'true'}, h('span', {class: 'slider-grip'}));
  const leftTag = h('span', {class: 'tag tag-left', 'aria-hidden': 'true'}, left.label);
  const rightTag = h('span', {class: 'tag tag-right', 'aria-hidden': 'true'}, right[0].label);
  const cut = (value) => {
    top.style.clipPath = `inset(0 ${100 - value}% 0 0)`;
    line.style.left = `${value}%`;
    leftTag.style.opacity = value > 18 ? '1' : '0';
    rightTag.style.opacity = value < 82 ? '1' : '0';
  };
  const range = h('input', {
    type: 'range', min: '0', max: '100', value: '50', class: 'slider-range',
    'aria-label': `${name}: ${left.label} to the left, ${right[0].label} to the right`,
    oninput: () => cut(Number(range.value))});
  cut(50);
  const frame = h('div', {class: 'slider-frame'}, bottom, top, line, leftTag, rightTag, range);
  const choose = (image) => {
    bottom.src = image.url;
    bottom.alt = `${image.label} of ${name}`;
    rightTag.textContent = image.label;
    range.setAttribute('aria-label', `${name}: ${left.label} to the left, ${image.label} to the right`);
  };
  return h('div', {class: 'slider'}, frame, right.length > 1 && choices(right, choose, `On the right of ${name}`));
}

// Radio buttons that look like a segmented switch.
export function choices(images, choose, label) {
  const group = uniqueId('choice');
  return h('div', {class: 'choices', role: 'radiogroup', 'aria-label': label}, images.map((image, i) => h('label', {},
    h('input', {type: 'radio', name: group, checked: i === 0, onchange: () => choose(image)}), h('span', {}, image.label))));
}
