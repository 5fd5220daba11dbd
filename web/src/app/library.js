// The library: a card for each splat. Cards stay the same elements while what they show changes.
import {h} from '../shared/dom.js';
import {bytes} from '../shared/format.js';
import {button, setText} from './parts.js';
import {change, remove, rename} from './project_actions.js';
import {canDo, countOf, progressLine, stateName, when} from './states.js';

class Card {
  constructor(session, id) {
    this.picture = h('img', {alt: '', loading: 'lazy', decoding: 'async', hidden: true});
    this.blank = h('span', {class: 'splat-blank', 'aria-hidden': 'true'}, 'No picture yet');
    this.name = h('span', {class: 'splat-name'});
    this.state = h('span', {class: 'state'});
    this.facts = h('span', {class: 'dim'});
    this.bar = h('progress', {max: 1, hidden: true});
    this.line = h('p', {class: 'note splat-line', hidden: true});
    const tool = (label, action) => button(label, () => action(this.project));
    this.tools = {
      start: tool('Continue', (project) => change(session, project, 'start', {})),
      rename: tool('Rename', (project) => rename(session, project)),
      delete: tool('Delete', (project) => this.remove(session, project)),
    };
    this.element = h('li', {class: 'splat'},
      h('a', {class: 'splat-open', href: `#/p/${encodeURIComponent(id)}`},
        h('span', {class: 'splat-picture'}, this.picture, this.blank), this.name),
      h('p', {class: 'splat-facts'}, this.state, ' ', this.facts), this.bar, this.line,
      h('div', {class: 'splat-tools'}, Object.values(this.tools)));
  }

  async remove(session, project) {
    const next = this.element.nextElementSibling ?? this.element.previousElementSibling;
    if (!(await remove(project))) return;
    await session.poll();
    (next?.querySelector('a') ?? document.querySelector('#main'))?.focus();
  }

  update(project) {
    if (this.project === project) return;
    this.project = project;
    const {name, state, progress} = project;
    setText(this.name, name);
    setText(this.state, stateName(state));
    this.state.dataset.state = state;
    setText(this.facts, [countOf(project.photos, 'photo'), bytes(project.bytes), when(project.changed)].filter(Boolean).join(' · '));
    this.picture.hidden = !project.picture;
    this.blank.hidden = Boolean(project.picture);
    if (project.picture && this.picture.getAttribute('src') !== project.picture) this.picture.src = project.picture;
    this.bar.hidden = !progress || !['running', 'paused'].includes(state);
    this.bar.setAttribute('aria-label', `Progress of ${name}`);
    if (!this.bar.hidden) this.bar.value = progress.share ?? 0;
    const line = progressLine(project);
    this.line.hidden = !line;
    setText(this.line, line);
    for (const [action, element] of Object.entries(this.tools)) {
      element.hidden = !canDo(project, action) || (action === 'start' && !['stopped', 'failed'].includes(state));
      element.setAttribute('aria-label', `${element.textContent}: ${name}`);
    }
  }
}

export class LibraryPage {
  constructor(session) {
    this.session = session;
    this.title = 'Your splats';
    this.cards = new Map();
    this.space = h('p', {class: 'note'});
    this.problem = h('p', {class: 'warning', role: 'alert', hidden: true});
    this.list = h('ul', {class: 'splats'});
    this.empty = h('div', {class: 'empty', hidden: true},
      h('h2', {}, 'Drop your photos here'),
      h('p', {}, 'From 12 to 24 photos of one thing or one room, OracleGS makes a splat: a 3D picture that you can walk around in. All is computed on this machine; nothing is sent anywhere.'),
      h('a', {class: 'button primary', href: '#/new'}, 'Choose photos'));
    this.loading = h('p', {class: 'note'}, 'Loading …');
    this.element = h('div', {class: 'library'},
      h('div', {class: 'page-head'}, h('h1', {tabIndex: -1}, this.title), this.space), this.problem, this.loading, this.empty, this.list);
  }

  update() {
    const {library} = this.session;
    if (!library || library === this.shown) return;
    this.shown = library;
    const {projects} = library;
    this.loading.hidden = true;
    this.empty.hidden = projects.length > 0;
    this.problem.hidden = !library.problem;
    setText(this.problem, library.problem ?? '');
    const taken = projects.reduce((sum, project) => sum + (project.bytes ?? 0), 0);
    setText(this.space, `${projects.length ? `${countOf(projects.length, 'splat')}, ${bytes(taken)}, in` : 'Kept in'} ${library.folder} · ${bytes(library.free_bytes)} free`);
    this.order(projects);
  }

  order(projects) {
    const focused = document.activeElement;
    const ids = new Set(projects.map(({id}) => id));
    for (const [id, card] of this.cards) {
      if (ids.has(id)) continue;
      card.element.remove();
      this.cards.delete(id);
    }
    projects.forEach((project, i) => {
      let card = this.cards.get(project.id);
      if (!card) this.cards.set(project.id, card = new Card(this.session, project.id));
      card.update(project);
      if (this.list.children[i] !== card.element) this.list.insertBefore(card.element, this.list.children[i] ?? null);
    });
    if (focused !== document.activeElement && this.list.contains(focused)) focused.focus({preventScroll: true});
  }
}
