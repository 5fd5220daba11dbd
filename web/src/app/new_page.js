// Where a splat begins: photos make a project, whose page then goes on.
import {h} from '../shared/dom.js';
import {post} from './api.js';
import {dropZone, MOST_FILES} from './drop.js';
import {howTo} from './how_to.js';
import {attempt, say} from './parts.js';
import {countOf} from './states.js';
import {uploadsOf} from './uploads.js';

export class NewPage {
  constructor(session) {
    this.session = session;
    this.title = 'New splat';
    this.element = h('div', {class: 'new'}, h('div', {class: 'page-head'}, h('h1', {tabIndex: -1}, this.title)),
      dropZone((drop) => begin(session, drop), 'Photos, a folder of them, a zip, or a video that you took while walking around. They stay on this machine.'),
      howTo());
  }

  update() {}
}

let beginning = false;

// Makes a project of what was dropped and goes to its page.
export async function begin(session, {files, name}) {
  if (files.length === 0) say('There is no file in it.', {bad: true});
  if (files.length === 0 || beginning) return;
  beginning = true;
  const today = new Date().toLocaleDateString('en', {month: 'long', day: 'numeric'});
  const made = await attempt(() => post('api/projects', {name: name || `Photos of ${today}`}));
  beginning = false;
  if (!made) return;
  addFiles(made.id, files);
  location.hash = `#/p/${encodeURIComponent(made.id)}`;
  session.poll();
}

// Adds files to a project that is there; those beyond what a project holds are left out.
export function addFiles(id, files, stored = []) {
  const uploads = uploadsOf(id);
  const room = Math.max(0, MOST_FILES - stored.length - uploads.pending);
  const {added, twice} = uploads.add(files.slice(0, room), stored);
  if (files.length > room) say(`A splat takes at most ${countOf(MOST_FILES, 'file')}. ${room === 0 ? 'None' : `Only the first ${room.toLocaleString('en')}`} of these ${room === 1 ? 'is' : 'are'} taken.`, {bad: true});
  if (twice > 0) say(added === 0 ? 'All of these are here already.' : `${twice} of these are here already and ${twice === 1 ? 'is' : 'are'} not sent twice.`);
}
