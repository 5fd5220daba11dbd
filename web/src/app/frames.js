// The splat in 3D, the report, the photos and the comparison: one at a time, by tabs.
import {fill, h, uniqueId} from '../shared/dom.js';
import {filesPath} from './api.js';
import {refill, setText} from './parts.js';
import {canDo} from './states.js';

const frame = (title, src, props = {}) => h('iframe', {title, src, class: 'view-frame', ...props});

// What the 3D view in a frame turns around: {point, distance}; undefined when there is none.
export const focusOf = (element) => {
  try {
    return element?.contentWindow?.oraclegs?.scene?.focus;
  } catch {
    return undefined;  // it has no pose yet
  }
};

export class Frames {
  // photos: element of the photos
  constructor(session, id, photos) {
    Object.assign(this, {session, id});
    this.view = h('div', {class: 'frame-box'});
    this.report = h('div', {class: 'frame-box'});
    this.other = h('select', {onchange: () => this.compare()});
    this.pair = h('div', {class: 'pair-frames'});
    this.tabs = new Map([
      this.tab('view', 'Splat', this.view), this.tab('photos', 'Photos', photos), this.tab('report', 'Report', this.report),
      this.tab('compare', 'Compare', h('div', {class: 'stack'}, h('label', {class: 'field'}, h('span', {}, 'Beside it'), this.other), this.pair))]);
    this.bar = h('div', {class: 'tabs', role: 'tablist', 'aria-label': 'What is shown', onkeydown: (event) => this.key(event)},
      [...this.tabs.values()].map(({button}) => button));
    this.links = h('p', {class: 'note frame-links'});
    this.element = h('div', {class: 'frames'}, this.bar, [...this.tabs.values()].map(({panel}) => panel), this.links);
  }

  tab(id, label, content) {
    const panelId = uniqueId('panel');
    const button = h('button', {type: 'button', role: 'tab', id: `${panelId}-tab`, 'aria-controls': panelId, onclick: () => this.choose(id)}, label);
    const panel = h('div', {role: 'tabpanel', id: panelId, 'aria-labelledby': `${panelId}-tab`, class: `tab-panel tab-${id}`}, content);
    return [id, {button, panel, label}];
  }

  get shownTabs() {
    return [...this.tabs].filter(([, {button}]) => !button.hidden).map(([id]) => id);
  }

  choose(id, {focus = false} = {}) {
    this.chosen = id;
    this.show();
    if (focus) this.tabs.get(id).button.focus();
  }

  key(event) {
    const all = this.shownTabs;
    const at = all.indexOf(this.current);
    const to = {ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: all.length - 1}[event.key];
    if (to === undefined) return;
    event.preventDefault();
    this.choose(all[(to + all.length) % all.length], {focus: true});
  }

  update(project) {
    this.project = project;
    const others = (this.session.library?.projects ?? []).filter((other) => other.id !== this.id && canDo(other, 'view'));
    const can = {view: canDo(project, 'view'), photos: true, report: canDo(project, 'report'), compare: canDo(project, 'view') && others.length > 0};
    for (const [id, {button}] of this.tabs) button.hidden = !can[id];
    setText(this.tabs.get('photos').button, `Photos (${project.photos})`);
    this.bar.hidden = this.shownTabs.length < 2;
    refill(this.other, others.map(({id, name}) => ({id, name})), (all) => {
      const chosen = this.other.value;
      return [h('option', {value: ''}, 'Choose a splat'), all.map(({id, name}) => h('option', {value: id, selected: id === chosen}, name))];
    });
    this.show();
  }

  show() {
    const all = this.shownTabs;
    this.current = all.includes(this.chosen) ? this.chosen : all[0];
    for (const [id, {button, panel}] of this.tabs) {
      const selected = id === this.current;
      button.setAttribute('aria-selected', String(selected));
      button.tabIndex = selected ? 0 : -1;
      panel.hidden = !selected;
    }
    const {name, changed} = this.project;
    if (all.includes('view') && !this.viewFrame) {
      this.viewFrame = frame(`${name} in 3D`, filesPath(this.id, 'view'), {onload: () => this.loaded()});
      fill(this.view, this.viewFrame);
    }
    if (this.current === 'report' && this.reported !== changed) {
      this.reported = changed;
      fill(this.report, frame(`Report of ${name}`, filesPath(this.id, 'report')));
    }
    if (this.current === 'compare' && !this.pair.firstChild) this.compare();
    const page = {view: 'view', report: 'report'}[this.current];
    refill(this.links, page, () => page && h('a', {href: filesPath(this.id, page), target: '_blank', rel: 'noopener'}, 'Open in a page of its own'));
  }

  loaded() {
    this.viewFrame.contentWindow.addEventListener('keydown', (event) => this.onViewKey?.(event));
    this.preview(this.edits);
  }

  // The 3D view leaves out what the edits leave out; one that loads later, too.
  preview(edits) {
    this.edits = edits;
    if (edits) this.viewFrame?.contentWindow?.postMessage({edits}, window.location.origin);
  }

  compare() {
    const other = this.session.library.projects.find(({id}) => id === this.other.value);
    const column = ({id, name}) => h('figure', {}, frame(`${name} in 3D`, filesPath(id, 'view')), h('figcaption', {class: 'note'}, name));
    fill(this.pair, other ? [column(this.project), column(other)] : h('p', {class: 'note'}, 'Two splats side by side. Choose the second one above.'));
  }
}
