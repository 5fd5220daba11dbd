// Sends the files of a project, few at a time. Event "item" with the item as detail; "idle" when none is left to send.
import {projectPath} from './api.js';

const AT_ONCE = 4;
const BUSY_MS = 1000;  // until a file is sent again that came when the program had enough to do

export class Uploads extends EventTarget {
  constructor(id) {
    super();
    this.id = id;
    this.items = new Map();  // by name and size
  }

  // stored: files that the project has already. How many were added and how many were there.
  add(files, stored = []) {
    const there = new Set(stored.map(({name, bytes: size}) => keyOf(name, size)));
    let twice = 0;
    for (const file of files) {
      const key = keyOf(file.name, file.size);
      if (there.has(key) || this.items.has(key)) {
        twice++;
        continue;
      }
      const reason = unfit(file);
      this.set({key, file, state: reason ? 'refused' : 'queued', sent: 0, reason});
    }
    this.pump();
    return {added: files.length - twice, twice};
  }

  get pending() {
    return [...this.items.values()].filter(({state}) => state === 'queued' || state === 'sending').length;
  }

  set(item) {
    this.items.set(item.key, item);
    this.dispatchEvent(new CustomEvent('item', {detail: item}));
  }

  retry(item) {
    Object.assign(item, {state: 'queued', sent: 0, reason: ''});
    this.set(item);
    this.pump();
  }

  get failed() {
    return [...this.items.values()].filter(({state}) => state === 'failed');
  }

  // Those that failed; or only those that broke off while the program was away.
  retryFailed({broken = false} = {}) {
    for (const item of this.failed) if (item.broken || !broken) this.retry(item);
  }

  drop(item) {
    item.request?.abort();
    item.state = 'gone';
    this.items.delete(item.key);
    this.dispatchEvent(new CustomEvent('item', {detail: item}));
    this.pump();
  }

  // Nothing is sent to a project that is gone.
  clear() {
    const all = [...this.items.values()];
    this.items.clear();  // first: what ends makes room for none of the others
    for (const item of all) this.drop(item);
  }

  // The program keeps the file no longer, so that it can be added again.
  forget(id) {
    for (const item of this.items.values()) if (item.id === id) this.items.delete(item.key);
  }

  pump() {
    const all = [...this.items.values()];
    let free = AT_ONCE - all.filter(({state}) => state === 'sending').length;
    for (const item of all) {
      if (free <= 0) break;
      if (item.state !== 'queued') continue;
      this.send(item);
      free--;
    }
    if (this.pending === 0) this.dispatchEvent(new Event('idle'));
  }

  send(item) {
    const request = new XMLHttpRequest();
    const end = (change) => {
      if (item.state === 'gone') return;
      this.set(Object.assign(item, {request: null, ...change}));
      this.pump();
    };
    request.open('POST', `${projectPath(this.id, 'upload')}?name=${encodeURIComponent(item.file.name)}`);
    request.upload.addEventListener('progress', ({loaded, total}) => {
      item.sent = total ? loaded / total : 0;
      this.set(item);
    });
    request.addEventListener('load', () => {
      const answer = parsed(request.responseText);
      if (request.status < 300 && answer.id) {
        end({state: 'done', id: answer.id, name: answer.name, doneAt: performance.now()});
        return;
      }
      if (request.status === 429) {  // another tab sends, too
        setTimeout(() => item.state === 'sending' && end({state: 'queued', sent: 0}), BUSY_MS);
        return;
      }
      const reason = answer.error || `The program answers ${request.status}.`;
      end({state: request.status === 415 ? 'refused' : 'failed', reason, broken: false});
    });
    request.addEventListener('error', () => end({state: 'failed', reason: 'The connection broke, or the file can no longer be read.', broken: true}));
    this.set(Object.assign(item, {state: 'sending', request}));
    request.send(item.file);
  }
}

const keyOf = (name, size) => `${name}\n${size}`;

// Why a file need not be sent; what is doubtful, the program decides.
function unfit({type, size}) {
  if (size === 0) return 'This file is empty.';
  const fits = !type || /^(image|video)\//.test(type) || /zip|octet-stream/.test(type);
  return fits ? '' : 'Not a photo, a video or a zip.';
}

function parsed(text) {
  try {
    return JSON.parse(text) ?? {};
  } catch {
    return {};
  }
}

const all = new Map();

// The uploads of a project go on while another page of the app is shown.
export function uploadsOf(id) {
  if (!all.has(id)) all.set(id, new Uploads(id));
  return all.get(id);
}

export const retryAllBroken = () => all.forEach((uploads) => uploads.retryFailed({broken: true}));
export const anyPending = () => [...all.values()].some((uploads) => uploads.pending > 0);
