// All views as a list of thumbnails: one stop of the Tab key, arrows choose.
import {ROLES} from '../shared/roles.js';
import {h, fill} from '../shared/dom.js';

export class ViewList {
  // resolve(url); onChoose(view); onMark(view or undefined): pointed at
  constructor(resolve, onChoose, onMark) {
    Object.assign(this, {resolve, onChoose, onMark, views: []});
    this.element = h('div', {
      class: 'view-list', role: 'listbox', 'aria-label': 'Views', tabIndex: 0, onkeydown: (event) => this.key(event)});
  }

  setViews(views) {
    this.views = Object.keys(ROLES).flatMap((role) => views.filter((view) => view.role === role));
    this.options = new Map();
    fill(this.element, Object.entries(ROLES).map(([role, {plural}]) => {
      const members = this.views.filter((view) => view.role === role);
      if (members.length === 0) return null;
      return h('div', {class: 'view-group', role: 'group', 'aria-label': plural},
        h('div', {class: 'view-group-name', 'aria-hidden': 'true'}, plural), members.map((view) => this.option(view)));
    }));
    this.element.hidden = this.views.length === 0;
    this.select(this.selected && this.views.find((view) => view.id === this.selected.id));
  }

  option(view) {
    const url = (view.thumbnail ?? view.image ?? view.render)?.url;
    const option = h('div', {
      class: `view-option role-${view.role}`, role: 'option', id: `view-${view.id}`, title: view.name,
      onclick: () => this.choose(view), onpointerenter: () => this.onMark(view), onpointerleave: () => this.onMark(undefined)},
    url ? h('img', {src: this.resolve(url), alt: '', loading: 'lazy', decoding: 'async'}) : h('span', {class: 'no-image'}),
    h('span', {class: 'view-name'}, view.name.split('/').pop()));
    this.options.set(view.id, option);
    return option;
  }

  choose(view) {
    this.select(view);
    this.onChoose(view);
  }

  select(view) {
    this.selected = view;
    for (const [id, option] of this.options) option.setAttribute('aria-selected', String(id === view?.id));
    const option = view && this.options.get(view.id);
    if (!option) {
      this.element.removeAttribute('aria-activedescendant');
      return;
    }
    this.element.setAttribute('aria-activedescendant', option.id);
    const box = this.element.getBoundingClientRect();
    const own = option.getBoundingClientRect();
    if (own.top < box.top || own.bottom > box.bottom) this.element.scrollTop += own.top - box.top - box.height / 3;
  }

  // step 1: the next view, -1: the one before.
  step(step) {
    if (this.views.length === 0) return;
    const at = this.views.indexOf(this.selected);
    this.choose(this.views[at < 0 ? (step > 0 ? 0 : this.views.length - 1) : (at + step + this.views.length) % this.views.length]);
  }

  key(event) {
    const steps = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1};
    if (steps[event.key]) this.step(steps[event.key]);
    else if (event.key === 'Home') this.choose(this.views[0]);
    else if (event.key === 'End') this.choose(this.views[this.views.length - 1]);
    else if (event.key === 'Enter' || event.key === ' ') this.choose(this.selected ?? this.views[0]);
    else return;
    event.preventDefault();
  }
}
