// The viewer: the 3D view of a run beside its images, while it trains and afterwards.
import {SplatScene} from '../scene/scene.js';
import {hasWebGL2} from '../scene/stage.js';
import {fill, h, put} from '../shared/dom.js';
import {number} from '../shared/format.js';
import {CompareOverlay} from '../ui/compare_overlay.js';
import {LensSlider} from '../ui/lens_slider.js';
import {ModePanel} from '../ui/mode_panel.js';
import {RoleToggles} from '../ui/role_toggles.js';
import {saveImage} from '../ui/save_image.js';
import {Suggestions} from '../ui/suggestions.js';
import {ViewDetails} from '../ui/view_details.js';
import {ViewList} from '../ui/view_list.js';
import {helpDialog, listenForKeys} from './keys.js';
import {RunPanel, stateName} from './run_panel.js';
import {fileUrl, Session} from './session.js';
import {SplatSource} from './splat_source.js';

const page = document.getElementById('page');
const title = h('h1', {}, 'OracleGS');
const facts = h('span', {class: 'facts'});
const badge = h('span', {class: 'badge', role: 'status', hidden: true});
const stage = h('main', {class: 'stage', 'aria-label': '3D view'});
const note = h('div', {class: 'stage-note', role: 'status'}, h('p', {}, 'Loading …'));
const mosaic = h('div', {class: 'mosaic', 'aria-hidden': 'true', hidden: true});  // the list beside has the same photos
const tip = h('div', {class: 'stage-tip', hidden: true});
const banner = h('div', {class: 'banner', role: 'alert', hidden: true}, 'The program has ended; this page stays as it is.');
const help = helpDialog();
put(stage, mosaic, note, tip, banner);

const session = new Session();
const run = new RunPanel();
const modes = new ModePanel((mode, hideBelow) => scene?.show(mode, hideBelow));
const suggestions = new Suggestions(stage, (view) => choose(view));
const roles = new RoleToggles((visible) => scene?.setVisible(visible));
const details = new ViewDetails(fileUrl, (view) => choose(view));
const list = new ViewList(fileUrl, (view) => choose(view), (view) => scene?.mark(view));

const tool = (label, key, action) => h('button', {type: 'button', title: `${label} (${key})`, onclick: action}, label, ' ', h('kbd', {'aria-hidden': 'true'}, key));
const camerasButton = tool('Cameras', 'C', () => roles.toggleAll());
const upButton = tool('Up', 'U', () => nextUp());
const imageButton = tool('Save image', 'I', () => save());
camerasButton.hidden = upButton.hidden = imageButton.hidden = true;
const foldButton = h('button', {type: 'button', class: 'fold', 'aria-controls': 'side', onclick: () => fold(!viewer.classList.contains('folded'))}, 'Panel');
const tools = h('div', {class: 'tools'},
  tool('Home', 'H', () => home()), upButton, camerasButton, imageButton, tool('Keys', '?', () => help.showModal()));

const viewsPanel = h('section', {class: 'panel views', hidden: true}, h('h2', {}, 'Views'), roles.element, list.element);
const viewer = h('div', {class: 'viewer'},
  h('header', {class: 'bar'}, title, badge, foldButton, facts, tools), stage,
  h('aside', {class: 'side', id: 'side', 'aria-label': 'Images and progress'},
    run.element, suggestions.element, modes.element, details.element, viewsPanel));
put(page, viewer, help);

// A narrow window folds the panel, so that the 3D view has all of it; so does the app's page around this one, which says
// itself what it shows and how the run goes.
viewer.classList.toggle('framed', window.parent !== window);
function fold(folded) {
  viewer.classList.toggle('folded', folded);
  foldButton.setAttribute('aria-expanded', String(!folded));
}

const say = (text) => {
  note.hidden = !text;
  note.firstChild.textContent = text;
};

let scene;
let overlay;
let source;
try {
  if (!hasWebGL2()) throw new Error('this browser has no WebGL 2, or it is switched off');
  scene = new SplatScene(stage);
  scene.setVisible(roles.visible);
  modes.element.append(new LensSlider(scene).element);
} catch (error) {
  say(`The 3D view needs WebGL 2, with which browsers draw in 3D: ${error.message}. Try another browser; the images beside it work without.`);
}

fold(Boolean(scene));

function choose(view) {
  list.select(view);
  details.show(view, session.document?.views ?? []);
  tidy();
  if (view.camera) scene?.goTo(view);
}

function home() {
  tidy();
  scene?.home();
}

// Takes away what belongs to one pose.
function tidy() {
  overlay?.hide();
  suggestions.hide();
}

function save() {
  if (!imageButton.hidden) saveImage(scene, title.textContent);
}

function nextUp() {
  if (!upButton.hidden) scene.nextUp();
}

if (scene) {
  overlay = new CompareOverlay(stage, scene, fileUrl, () => overlay.hide());
  source = new SplatSource(scene, say, shown);
  scene.addEventListener('view', (event) => choose(event.detail));
  scene.addEventListener('arrive', ({detail: view}) => suggestions.arrived(view) || overlay.show(view));
  scene.addEventListener('move', tidy);
  scene.addEventListener('hover', ({detail: view}) => {
    tip.hidden = !view;
    tip.textContent = view ? view.name : '';
  });
  scene.addEventListener('lost', () => say('The graphics driver has reset the 3D view. Reload the page.'));
  scene.addEventListener('range', ({detail: range}) => modes.setRange(range));
  scene.addEventListener('drawn', () => { if (scene.mesh) stage.dataset.drawn = source.shown; });
}

function shown() {
  modes.setKnown(scene.marks, scene.classCounts);
  imageButton.hidden = false;
  showFacts();
}

function showFacts() {
  const gaussians = scene?.gaussians || session.document?.splat?.gaussians;
  const live = source?.isLive ? session.live?.splat : undefined;
  const iteration = live?.iteration;
  const points = live?.of?.endsWith('points') && live.of;
  facts.textContent = [
    gaussians && `${number(gaussians)} ${points || 'Gaussians'}`, live?.of === 'draft model' && 'draft', iteration && `iteration ${number(iteration)}`,
    Number.isFinite(session.document?.scores?.psnr) && `PSNR ${number(session.document.scores.psnr, 2)} dB`].filter(Boolean).join(' · ');
}

// Photos without cameras have no place in 3D: they fill the stage until they have one.
function showMosaic(views) {
  mosaic.hidden = views.length === 0 || views.some((view) => view.camera);
  fill(mosaic, mosaic.hidden ? [] : views.map((view) => h('img', {src: fileUrl((view.image ?? view.thumbnail).url), alt: ''})));
}

function showState(live) {
  badge.hidden = !live;
  badge.textContent = stateName(live);
  badge.dataset.state = live?.state ?? '';
  run.update(live);
}

let shownDocument;
session.addEventListener('change', () => {
  const {document: doc, live} = session;
  showState(live);
  const described = JSON.stringify([doc?.views, doc?.place, doc?.splat, doc?.registration?.advice]);
  if (doc && described !== shownDocument) {
    shownDocument = described;
    list.setViews(doc.views ?? []);
    roles.setViews(doc.views ?? []);
    suggestions.setRun(scene && doc);
    viewsPanel.hidden = camerasButton.hidden = !doc.views?.length;
    upButton.hidden = !viewsPanel.hidden || !scene;
    scene?.setDocument(doc);
    showMosaic(doc.views ?? []);
  }
  if (doc?.title) {
    title.textContent = doc.title;
    document.title = `${doc.title} – OracleGS`;
  }
  showFacts();
  source?.update(session);
});
session.addEventListener('gone', () => {
  banner.hidden = false;
  if (session.running) showState({...session.live, state: 'ended'});
});
session.addEventListener('back', () => {
  banner.hidden = true;
  showState(session.live);
});

listenForKeys({
  m: () => modes.next(), p: () => modes.toggle('provenance'), i: save, h: home, u: nextUp, c: () => roles.toggleAll(), n: () => list.step(1), b: () => list.step(-1),
  '?': () => help.showModal(), Escape: tidy,
  f: () => (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen?.().catch(() => {})),
});

// The app's page around this one says what its edits are.
window.addEventListener('message', ({origin, source, data}) => {
  if (origin === window.location.origin && source === window.parent && data?.edits) scene?.edit(data.edits);
});

globalThis.oraclegs = {scene, session};  // for the console and for tests
session.start().then(() => {
  if (!session.asked) say('The program does not answer.');
});
