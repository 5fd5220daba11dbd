// One splat: its photos before the start, how the work goes, and what came of it.
import {h} from '../shared/dom.js';
import {chooser} from './drop.js';
import {Downloads} from './downloads.js';
import {Edits} from './edits.js';
import {Frames} from './frames.js';
import {howTo} from './how_to.js';
import {addFiles} from './new_page.js';
import {button, say, setText} from './parts.js';
import {PhotoGrid} from './photo_grid.js';
import {ProgressPanel} from './progress_panel.js';
import {remove, rename} from './project_actions.js';
import {StartPanel} from './start_panel.js';
import {canDo, countOf, stateName} from './states.js';
import {uploadsOf} from './uploads.js';

const EARLY = {
  waiting: 'The splat appears here once its turn has come.', running: 'The splat appears here as soon as there is something to see.'};

export class ProjectPage {
  constructor(session, id) {
    Object.assign(this, {session, id, title: 'Splat', uploads: uploadsOf(id)});
    this.heading = h('h1', {tabIndex: -1}, '…');
    this.state = h('span', {class: 'state'});
    this.facts = h('span', {class: 'note'});
    this.renameButton = button('Rename', () => rename(session, this.project));
    this.deleteButton = button('Delete', async () => {
      if (await remove(this.project)) location.hash = '#/';
    });
    this.missing = h('p', {class: 'message', hidden: true}, 'There is no such splat; it may have been deleted. ', h('a', {href: '#/'}, 'Back to your splats'));

    this.grid = new PhotoGrid(session, this.uploads);
    this.adder = h('div', {class: 'drop small'}, chooser((drop) => this.take(drop), 'Add photos', false), h('span', {class: 'note'}, 'or drop them anywhere'));
    this.how = h('details', {class: 'how'}, h('summary', {}, 'How to photograph'), howTo());
    this.early = h('p', {class: 'early'});
    this.photos = h('div', {class: 'stack'}, this.adder, this.grid.element, this.how);
    this.frames = new Frames(session, id, this.photos);
    this.start = new StartPanel(session, this.uploads, chooser((drop) => this.take(drop), 'Add photos', false));
    this.progress = new ProgressPanel(session);
    this.downloads = new Downloads(session);
    this.edits = new Edits(session, id, this.frames);
    this.quality = h('p', {class: 'note'});
    this.panels = [this.start, this.progress, this.downloads, this.edits, this.frames];
    this.side = h('div', {class: 'side-column'});
    this.content = h('div', {class: 'columns', hidden: true}, this.side, h('div', {class: 'main-column'}, this.early, this.frames.element));
    this.element = h('div', {class: 'project'},
      h('div', {class: 'page-head'}, h('div', {class: 'head-text'}, this.heading, h('p', {class: 'head-facts'}, this.state, ' ', this.facts), this.quality),
        h('div', {class: 'row'}, this.renameButton, this.deleteButton)), this.missing, this.content);
  }

  close() {
    this.grid.close();
    this.start.close();
    this.edits.close();
  }

  // What is reached first is what one came for: the start before hundreds of photos, the progress, the splat before its downloads.
  arrange(state) {
    const order = state === 'finished' ? ['downloads', 'edits', 'start', 'progress'] : ['progress', 'start', 'downloads', 'edits'];
    const key = order.join();
    if (this.arranged === key) return;
    this.arranged = key;
    const focused = document.activeElement;
    this.side.append(...order.map((name) => this[name].element));
    if (state === 'finished') this.content.append(this.side);  // the other column stays: a frame that moves loads again
    else this.content.prepend(this.side);
    if (this.side.contains(focused)) focused.focus({preventScroll: true});
  }

  update() {
    const {project, missing} = this.session;
    this.missing.hidden = !missing;
    this.content.hidden = !project;
    this.renameButton.hidden = !canDo(project ?? {}, 'rename');
    this.deleteButton.hidden = !canDo(project ?? {}, 'delete');
    if (missing) setText(this.heading, 'Not found');
    if (!project) return;
    this.project = project;
    this.title = project.name;
    setText(this.heading, project.name);
    setText(this.state, stateName(project.state));
    this.state.dataset.state = project.state;
    setText(this.facts, countOf(project.photos, 'photo'));
    const words = project.state === 'finished' && likeness(project.scores?.psnr);
    this.quality.hidden = !words;
    setText(this.quality, words || '');
    this.arrange(project.state);
    for (const panel of this.panels) panel.update(project);
    this.grid.update(project);
    this.adder.hidden = !canDo(project, 'upload');
    this.how.hidden = project.state !== 'new';
    const early = canDo(project, 'view') ? '' : (EARLY[project.state] ?? '');
    this.early.hidden = !early;
    setText(this.early, early);
  }

  take({files}) {
    if (!this.project || !canDo(this.project, 'upload')) {
      say('Photos cannot be added while the splat is in work. Stop it first, or wait until it is done.', {bad: true});
      return;
    }
    addFiles(this.id, files, this.project.files);
    this.frames.choose('photos');
  }
}

// PSNR, dB, in words.
function likeness(psnr) {
  if (!Number.isFinite(psnr)) return '';
  const word = psnr >= 30 ? 'very good' : psnr >= 25 ? 'good' : psnr >= 20 ? 'fair' : 'poor';
  return `Likeness to photos that it was not made from: ${word}`;
}
