// The images of the chosen view beside the 3D view: for an invented view also how far it is trusted.
import {imagesOf, ROLES} from '../shared/roles.js';
import {h, fill} from '../shared/dom.js';
import {number} from '../shared/format.js';
import {plasmaLegend} from './plasma_legend.js';

export class ViewDetails {
  // resolve(url); onChoose(view)
  constructor(resolve, onChoose) {
    Object.assign(this, {resolve, onChoose});
    this.element = h('section', {class: 'panel details', hidden: true, 'aria-label': 'The chosen view', 'aria-live': 'polite'});
  }

  show(view, views) {
    this.element.hidden = !view;
    if (!view) return;
    const nearest = views.find((other) => other.id === view.nearest && other.id !== view.id);
    const facts = [
      Number.isFinite(view.psnr) && `PSNR ${number(view.psnr, 2)} dB`, Number.isFinite(view.ssim) && `SSIM ${number(view.ssim, 3)}`,
      Number.isFinite(view.mean_confidence) && `mean trust ${number(view.mean_confidence, 2)}`,
      view.source && `from ${view.source}`].filter(Boolean);
    fill(this.element,
      h('h2', {}, `${ROLES[view.role]?.name ?? 'View'} `, h('span', {class: 'dim'}, view.name)),
      facts.length > 0 && h('p', {class: 'note'}, facts.join(' · ')),
      h('div', {class: 'detail-images'}, imagesOf(view).map((image) => this.figure(image, view)),
        nearest?.image && h('figure', {}, h('button', {type: 'button', class: 'plain', onclick: () => this.onChoose(nearest)},
          this.picture({label: 'Photo', url: nearest.image.url}, nearest)), h('figcaption', {}, `Nearest photo: ${nearest.name}`))),
      view.confidence && plasmaLegend());
  }

  figure(image, view) {
    return h('figure', {}, this.picture(image, view), h('figcaption', {}, image.label));
  }

  picture(image, view) {
    return h('img', {src: this.resolve(image.url), alt: `${image.label} of ${view.name}`, loading: 'lazy', decoding: 'async'});
  }
}
