// One photo, video or zip: small picture, name, how far it is sent, what is wrong with it.
import {fill, h} from '../shared/dom.js';
import {bytes} from '../shared/format.js';
import {button, setText} from './parts.js';

const UNSEEN = /^(HEIC|HEIF|TIFF?)$/;  // photos that the program reads and most browsers do not
const ending = (name) => (/\.([^.]{1,5})$/.exec(name)?.[1] ?? 'file').toUpperCase();

export class PhotoTile {
  // actions: {remove(tile), retry(tile)}
  constructor(name, size, actions) {
    this.name = name;
    this.picture = h('span', {class: 'photo-picture'}, h('span', {class: 'photo-type', 'aria-hidden': 'true'}, ending(name)));
    this.bar = h('progress', {max: 1, value: 0, hidden: true, 'aria-label': `Sent of ${name}`});
    this.state = h('span', {class: 'photo-state note'});
    this.reasons = h('ul', {class: 'photo-reasons', hidden: true});
    this.retryButton = button('Try again', () => actions.retry(this), {'aria-label': `Try again: ${name}`, hidden: true});
    this.removeButton = button('×', () => actions.remove(this), {class: 'photo-remove', 'aria-label': `Remove ${name}`, title: 'Remove'});
    this.element = h('li', {class: 'photo'}, this.picture,
      h('span', {class: 'photo-name', title: `${name}, ${bytes(size)}`}, name), this.state, this.bar, this.reasons, this.retryButton, this.removeButton);
  }

  showPicture(address) {
    if (address) fill(this.picture, h('img', {src: address, alt: '', decoding: 'async'}));
    else this.picture.append(h('span', {class: 'photo-nopreview'}, UNSEEN.test(ending(this.name)) ? 'Your browser cannot show this kind of photo. OracleGS can read it.' : 'no preview'));
  }

  showUpload({state, sent, reason}) {
    this.element.dataset.state = state;
    this.bar.hidden = state !== 'sending';
    this.bar.value = sent;
    setText(this.state, {queued: 'Waits', sending: ''}[state] ?? '');
    this.retryButton.hidden = state !== 'failed';
    this.showReasons(reason ? [reason] : []);
  }

  showStored(texts, removable) {
    if (this.element.dataset.state !== 'stored') {
      this.element.dataset.state = 'stored';
      this.bar.hidden = this.retryButton.hidden = true;
      setText(this.state, '');
    }
    this.removeButton.hidden = !removable;
    this.showReasons(texts);
  }

  showReasons(texts) {
    const key = texts.join('\n');
    if (this.reasonsKey === key) return;
    this.reasonsKey = key;
    this.reasons.hidden = texts.length === 0;
    this.element.classList.toggle('marked', texts.length > 0);
    fill(this.reasons, texts.map((text) => h('li', {}, text)));
  }
}
