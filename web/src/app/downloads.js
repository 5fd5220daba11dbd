// Files for other programs: made when asked for, downloaded as soon as they are done.
import {h} from '../shared/dom.js';
import {bytes} from '../shared/format.js';
import {filesPath, post, projectPath} from './api.js';
import {announce, attempt, button, refill, say, setText} from './parts.js';
import {canDo, halves} from './states.js';

export class Downloads {
  constructor(session) {
    Object.assign(this, {session, wanted: new Map()});  // what this page has asked for: id to when
    this.buttons = h('div', {class: 'formats'});
    this.list = h('ul', {class: 'exports', 'aria-label': 'Made files'});
    this.editor = h('div', {class: 'stack editor'},
      h('a', {class: 'button', href: 'https://superspl.at/editor', target: '_blank', rel: 'noopener noreferrer'}, 'Paint and erase in SuperSplat ↗'),
      h('p', {class: 'note'}, 'Opens a site on the internet in a new tab. Download the PLY first, then drop it there; it is opened in your browser and is not uploaded by OracleGS.'));
    this.element = h('section', {class: 'card stack', 'aria-label': 'Download'}, h('h2', {}, 'Download'), this.buttons, this.list, this.editor);
  }

  update(project) {
    this.project = project;
    this.element.hidden = !canDo(project, 'export');
    const exports = project.exports ?? [];
    refill(this.buttons, this.session.library?.formats ?? [], (formats) => formats.map((format) => this.formatButton(format)));
    for (const element of this.buttons.children) {
      const {format, note} = element.dataset;
      const busy = exports.some((entry) => entry.format === format && entry.state === 'running');
      element.setAttribute('aria-disabled', String(busy));
      setText(element.lastChild, busy ? 'is made …' : note);
    }
    refill(this.list, exports, (all) => all.map((entry) => this.item(entry)));
    this.list.hidden = exports.length === 0;
    const isNew = ({id, state}) => this.wanted.get(id) < project.asked && state !== 'running';  // not that of an earlier export
    for (const entry of exports.filter(isNew)) this.take(entry);
  }

  formatButton({id, label}) {
    const [name, note] = halves(label);
    return button([h('span', {class: 'format-name'}, h('span', {class: 'visually-hidden'}, 'Download '), name), ' ', h('span', {class: 'note'})], ({currentTarget}) => {
      if (currentTarget.getAttribute('aria-disabled') !== 'true') this.make(id);
    }, {class: 'format', 'data-format': id, 'data-note': note});
  }

  item({id, name, bytes: size, state, message}) {
    if (state === 'done') return h('li', {}, h('a', {href: this.addressOf(id), download: name}, name), h('span', {class: 'note'}, ` ${bytes(size)}`));
    if (state === 'failed') return h('li', {class: 'problem'}, `${name}: ${message || 'it could not be made'}`);
    return h('li', {class: 'note'}, `${name} is made …`);
  }

  addressOf(id) {
    return filesPath(this.project.id, `exports/${encodeURIComponent(id)}`);
  }

  async make(format) {
    const answer = await attempt(() => post(projectPath(this.project.id, 'export'), {format}));
    if (!answer) return;
    this.wanted.set(answer.id, performance.now());
    announce('The file is made; it is downloaded when it is done.');
    this.session.poll();
  }

  take({id, name, state, message}) {
    this.wanted.delete(id);
    if (state === 'failed') {
      say(`${name} could not be made. ${message ?? ''}`, {bad: true});
      return;
    }
    const link = h('a', {href: this.addressOf(id), download: name, class: 'visually-hidden'});
    document.body.append(link);
    link.click();
    link.remove();
    announce(`${name} is downloaded.`);
  }
}
