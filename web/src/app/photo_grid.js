// The photos of a project: those that it has and those that are on their way.
import {h} from '../shared/dom.js';
import {filesPath, post, projectPath} from './api.js';
import {announce, attempt, button, setText, soon} from './parts.js';
import {PhotoTile} from './photo_tile.js';
import {canDo, countOf} from './states.js';
import {Thumbnails} from './thumbnails.js';

const AT_ONCE = 500;  // tiles that are shown; ten thousand would make a page slow

export class PhotoGrid {
  constructor(session, uploads) {
    Object.assign(this, {session, uploads, stored: new Map(), sending: new Map(), forgotten: new Map(), unseen: new Map(), most: AT_ONCE});  // forgotten: id to when; unseen: tile to its photo
    this.thumbnails = new Thumbnails();
    this.summary = h('p', {class: 'photo-summary'});
    this.general = h('ul', {class: 'photo-general', hidden: true});
    this.list = h('ul', {class: 'photos', 'aria-label': 'Photos'});
    this.again = button('Try all of them again', () => this.uploads.retryFailed(), {hidden: true});
    this.more = button('', () => this.showMore(), {hidden: true});
    this.element = h('div', {class: 'stack'}, h('div', {}, this.summary, this.again, this.general, this.list), this.more);
    this.countSoon = soon(() => this.count());
    this.onItem = ({detail}) => this.take(detail);
    this.onIdle = () => this.count(true);
    for (const item of uploads.items.values()) this.take(item);
    uploads.addEventListener('item', this.onItem);
    uploads.addEventListener('idle', this.onIdle);
  }

  close() {
    this.uploads.removeEventListener('item', this.onItem);
    this.uploads.removeEventListener('idle', this.onIdle);
  }

  tile(name, size, blobOf) {
    const tile = new PhotoTile(name, size, {remove: (which) => this.remove(which), retry: ({item}) => this.uploads.retry(item)});
    this.unseen.set(tile, blobOf);
    this.fillUp();
    return tile;
  }

  // to: 'append' or 'prepend'
  show(tile, to = 'append') {
    this.list[to](tile.element);
    const blobOf = this.unseen.get(tile);
    if (blobOf) this.thumbnails.want(tile.picture, blobOf, (address) => tile.showPicture(address));
    this.unseen.delete(tile);
  }

  fillUp() {
    for (const tile of this.unseen.keys()) {
      if (this.list.childElementCount >= this.most) return;
      this.show(tile);
    }
  }

  showMore() {
    const [next] = this.unseen.keys();
    this.most = this.list.childElementCount + AT_ONCE;
    this.fillUp();
    this.count();
    if (this.more.hidden) next?.element.querySelector('.photo-remove')?.focus();
  }

  take(item) {
    let tile = this.sending.get(item.key);
    if (item.state === 'gone') {
      this.drop(tile);
      this.sending.delete(item.key);
    } else if (item.state === 'done') {
      this.keep(item, tile);
    } else {
      if (!tile) this.sending.set(item.key, tile = this.tileOf(item));
      tile.item = item;
      tile.showUpload(item);
      if (item.reason && !item.shown) this.show(tile, 'prepend');  // to be seen among hundreds
      item.shown = Boolean(item.reason);
    }
    this.countSoon();
  }

  tileOf({file}) {
    return this.tile(file.name, file.size, !/^video\/|zip/.test(file.type) && (async () => file));
  }

  // The tile of an upload becomes that of the stored file.
  keep(item, tile) {
    this.sending.delete(item.key);
    if (this.stored.has(item.id) || !this.uploads.items.has(item.key)) {
      this.drop(tile);
      return;
    }
    tile ??= this.tileOf(item);  // stored before this page was there
    Object.assign(tile, {id: item.id, since: item.doneAt, item: null});
    tile.showStored([], true);
    this.stored.set(item.id, tile);
  }

  drop(tile) {
    if (!tile) return;
    const next = tile.element.nextElementSibling ?? tile.element.previousElementSibling;
    const focused = tile.element.contains(document.activeElement);
    this.thumbnails.forget(tile.picture);
    tile.element.remove();
    this.unseen.delete(tile);
    this.fillUp();
    if (focused) next?.querySelector('.photo-remove')?.focus();
  }

  async remove(tile) {
    if (tile.item) {
      this.uploads.drop(tile.item);
      return;
    }
    const {id} = tile;
    const done = await attempt(() => post(projectPath(this.uploads.id, 'forget'), {file: id}));
    if (!done) return;
    this.forgotten.set(id, performance.now());
    this.uploads.forget(id);
    this.stored.delete(id);
    this.drop(tile);
    this.session.poll();
  }

  update(project) {
    this.project = project;
    const files = (project.files ?? []).filter(({id}) => !(project.asked < this.forgotten.get(id)));
    const listed = new Set(files.map(({id}) => id));
    for (const [id, tile] of this.stored) {
      if (listed.has(id) || tile.since > project.asked) continue;  // stored after the program was asked
      this.drop(tile);
      this.stored.delete(id);
    }
    const reasons = new Map();
    const general = [];
    for (const {text, files: of = []} of project.check?.warnings ?? []) {
      const known = of.filter((id) => listed.has(id));
      if (known.length === 0) general.push(text);
      for (const id of known) reasons.set(id, [...(reasons.get(id) ?? []), text]);
    }
    if (project.state === 'failed') {
      for (const {id, name} of files) if (names(project.message, name)) reasons.set(id, [...(reasons.get(id) ?? []), 'Named where it says why it ended.']);
    }
    const removable = canDo(project, 'upload');
    for (const file of files) {
      let tile = this.stored.get(file.id);
      if (!tile) {
        const address = filesPath(project.id, `photos/${encodeURIComponent(file.id)}`);
        tile = this.tile(file.name, file.bytes, file.kind === 'photo' && (() => photoAt(address)));
        tile.id = file.id;
        this.stored.set(file.id, tile);
      }
      if (reasons.has(file.id) && this.unseen.has(tile)) this.show(tile, 'prepend');
      tile.showStored(reasons.get(file.id) ?? [], removable);
    }
    this.marked = reasons.size;
    this.general.hidden = general.length === 0;
    const key = general.join('\n');
    if (this.generalKey !== key) {
      this.generalKey = key;
      this.general.replaceChildren(...general.map((text) => h('li', {class: 'warning'}, text)));
    }
    this.count();
  }

  count(aloud = false) {
    const items = [...this.uploads.items.values()];
    const pending = this.uploads.pending;
    const failed = items.filter(({state}) => state === 'failed' || state === 'refused').length;
    const checking = this.project?.check?.state === 'running';
    const text = [
      countOf(this.stored.size, 'file'), pending > 0 && `${pending} on the way`,
      failed > 0 && `${countOf(failed, 'file')} could not be taken; the reason is beside each`,
      checking && 'the photos are being looked at',
      this.marked > 0 && `${countOf(this.marked, 'photo')} may do harm; the reason is beside each`].filter(Boolean).join(' · ');
    setText(this.summary, text);
    this.again.hidden = this.uploads.failed.length < 2;
    this.more.hidden = this.unseen.size === 0;
    setText(this.more, `Show ${Math.min(AT_ONCE, this.unseen.size)} more of ${countOf(this.unseen.size, 'file')}`);
    if (aloud && items.length > 0) announce(text);
  }
}

// Whether the text speaks of the file: "1.jpg" is not meant by "11.jpg".
function names(text, name) {
  const at = text?.indexOf(name) ?? -1;
  return at >= 0 && !/[\w-]/.test(text[at - 1] ?? ' ') && !/\w/.test(text[at + name.length] ?? ' ');
}

async function photoAt(address) {
  const response = await fetch(address);
  if (!response.ok) throw new Error(`${address}: ${response.status}`);
  return response.blob();
}
