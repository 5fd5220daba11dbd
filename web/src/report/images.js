// Test views with a slider between render and truth; invented views with what became of them.
import {h} from '../shared/dom.js';
import {number} from '../shared/format.js';
import {CLASSES} from '../shared/support_classes.js';
import {imageSlider} from '../ui/image_slider.js';
import {errorLegend, plasmaLegend} from '../ui/plasma_legend.js';
import {swatch} from '../ui/swatches.js';

const MAX_OPEN = 8;  // invented views that are shown without a click
const MAX_TRAINED = 6;  // training views beside their renders

// Photos that were held out; without them some that were trained on.
export function comparisons(run) {
  const of = (role) => (run.views ?? []).filter((view) => view.role === role && view.render?.url && view.image?.url);
  const trained = of('train');
  const step = Math.max(1, Math.ceil(trained.length / MAX_TRAINED));
  const views = of('test').length ? of('test') : trained.filter((_, i) => i % step === 0);
  if (views.length === 0) return null;
  const supported = views.some((view) => view.support?.url), unsure = views.some((view) => view.uncertainty?.url);
  return h('div', {},
    h('p', {class: 'lead'}, 'Drag the slider: the render is on the left. The right side shows the photo',
      views.some((view) => view.error?.url) && ', or where the two differ', unsure && ', or where the program expects them to, without having seen the photo', supported && ', or how well photos support the render', '.'),
    unsure && errorLegend(), supported && supportLegend(),
    h('div', {class: 'pairs'}, views.map(pair)));
}

function pair(view) {
  const right = [['Photo', view.image], ['Error', view.error], ['Expected error', view.uncertainty], ['Support', view.support]]
    .filter(([, image]) => image?.url).map(([label, image]) => ({label, url: image.url}));
  const facts = [Number.isFinite(view.psnr) && `${number(view.psnr, 2)} dB`, Number.isFinite(view.ssim) && `SSIM ${number(view.ssim, 3)}`];
  return h('article', {class: 'pair'}, h('h3', {}, view.name, h('span', {}, facts.filter(Boolean).join(' · '))),
    imageSlider({left: {label: 'Render', url: view.render.url}, right, name: view.name, width: view.camera?.width, height: view.camera?.height}));
}

export function supportLegend() {
  return h('div', {class: 'plan-legend'}, CLASSES.map(({name, color}) => h('span', {}, swatch(color), name)));
}

export function proposals(run) {
  const views = run.views ?? [];
  const list = views.filter((view) => view.role === 'proposal' && view.image?.url);
  if (list.length === 0) return null;
  const byId = new Map(views.map((view) => [view.id, view]));
  const rows = list.map((view) => proposal(view, byId.get(view.nearest)));
  return h('div', {},
    h('p', {class: 'lead'}, 'A view that no camera took, how far the program trusts each pixel of it, the final render from there, and the nearest photo.'),
    plasmaLegend(), rows.slice(0, MAX_OPEN),
    rows.length > MAX_OPEN && h('details', {}, h('summary', {}, `The other ${rows.length - MAX_OPEN} invented views`), rows.slice(MAX_OPEN)));
}

function proposal(view, nearest) {
  const images = [
    ['Invented view', view.image, view.name], ['Trust', view.confidence, view.name], ['Final render', view.render, view.name],
    [`Nearest photo${nearest ? `: ${nearest.name}` : ''}`, nearest?.image ?? nearest?.thumbnail, nearest?.name]].filter(([, image]) => image?.url);
  const facts = [view.source && `from ${view.source}`, Number.isFinite(view.mean_confidence) && `mean trust ${number(view.mean_confidence, 2)}`];
  return h('article', {class: 'proposal'}, h('h3', {}, view.name, h('span', {}, facts.filter(Boolean).join(' · '))),
    h('div', {class: 'strip'}, images.map(([label, image, name]) => h('figure', {},
      h('img', {src: image.url, alt: `${label} of ${name}`, loading: 'lazy', decoding: 'async', width: view.camera?.width, height: view.camera?.height}),
      h('figcaption', {}, label)))));
}
