// The splat in 3D inside the report. Nothing of it is unpacked before it is asked for.
import packed from 'packed:scene';
import {fromBase64, splatOf} from '../shared/bytes.js';
import {h, fill, put} from '../shared/dom.js';
import {ROLES} from '../shared/roles.js';
import {CompareOverlay} from '../ui/compare_overlay.js';
import {LensSlider} from '../ui/lens_slider.js';
import {ModePanel} from '../ui/mode_panel.js';
import {RoleToggles} from '../ui/role_toggles.js';
import {saveImage} from '../ui/save_image.js';
import {Suggestions} from '../ui/suggestions.js';

export function explorer(run) {
  if (!run.splat?.url) return null;
  const stage = h('div', {class: 'stage', role: 'group', 'aria-label': '3D view'});
  const note = h('div', {class: 'stage-note'});
  const tools = h('div', {class: 'explorer-tools', hidden: true});
  const poster = run.hero?.url ?? run.views?.find((view) => view.image?.url)?.image.url;
  put(stage, poster && h('img', {class: 'poster', src: poster, alt: '', decoding: 'async'}), note);
  const start = () => open(run, stage, note, tools).catch((error) => say(note, `The 3D view cannot be shown: ${error.message}.`));
  fill(note, h('button', {type: 'button', class: 'primary', onclick: start}, 'Show in 3D'),
    h('p', {class: 'note'}, 'Drag to turn, scroll or pinch to go nearer, click a camera to compare with its image.'));
  return h('div', {class: 'explorer'}, stage, tools);
}

function say(note, text) {
  note.hidden = !text;
  fill(note, h('p', {role: 'status'}, text));
}

async function open(run, stage, note, tools) {
  if (!document.createElement('canvas').getContext('webgl2')) throw new Error('this browser has no WebGL 2, or it is switched off');
  say(note, 'Loading the splat …');
  const {SplatScene} = await unpackScene();
  const splat = await splatOf(run.splat, (url) => url);
  const scene = new SplatScene(stage, {wheelNeedsFocus: true});
  const overlay = new CompareOverlay(stage, scene, (url) => url, () => overlay.hide());
  scene.setDocument(run);
  await scene.setSplat(splat);
  say(note, '');
  stage.querySelector('.poster')?.remove();

  const tidy = () => {  // takes away what belongs to one pose
    overlay.hide();
    suggestions.hide();
  };
  const goTo = (view) => {
    tidy();
    if (view) scene.goTo(view);
    else scene.home();
  };
  const suggestions = new Suggestions(stage, goTo);
  suggestions.setRun(run);
  const chooser = viewChooser(run.views ?? [], goTo);
  const modes = new ModePanel((mode, hideBelow) => scene.show(mode, hideBelow));
  modes.setKnown(scene.marks, scene.classCounts);
  modes.element.append(new LensSlider(scene).element);
  const roles = new RoleToggles((visible) => scene.setVisible(visible));
  roles.setViews(scene.views);
  scene.setVisible(roles.visible);
  const save = () => saveImage(scene, run.title);
  fill(tools, h('div', {class: 'panel'}, chooser.element, roles.element, h('p', {}, h('button', {type: 'button', onclick: save}, 'Save image'))),
    modes.element, suggestions.element);
  tools.hidden = false;
  scene.addEventListener('view', ({detail: view}) => goTo(view));
  scene.addEventListener('arrive', ({detail: view}) => {
    chooser.select(view);
    if (!suggestions.arrived(view)) overlay.show(view);
  });
  scene.addEventListener('move', () => {
    tidy();
    chooser.select(undefined);
  });
  scene.addEventListener('range', ({detail: range}) => modes.setRange(range));
  scene.addEventListener('drawn', () => { stage.dataset.drawn = 'splat'; });
  scene.addEventListener('lost', () => say(note, 'The graphics driver has reset the 3D view. Reload the page.'));
  const keys = {p: () => modes.toggle('provenance'), m: () => modes.next(), i: save, Escape: tidy};
  stage.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    keys[event.key.length === 1 ? event.key.toLowerCase() : event.key]?.();
  });
  scene.canvas.setAttribute('aria-label', '3D view: arrow keys turn, W A S D move, plus and minus zoom, M changes what is shown, P shows provenance, I saves an image');
  globalThis.oraclegs = {scene};  // for the console and for tests
  scene.canvas.focus({preventScroll: true});
}

async function unpackScene() {
  if (!globalThis.OracleGSScene) {
    const stream = new Blob([fromBase64(packed)]).stream().pipeThrough(new DecompressionStream('gzip'));
    const script = document.createElement('script');
    script.textContent = await new Response(stream).text();
    document.head.append(script);
    script.remove();
  }
  return globalThis.OracleGSScene;
}

// A drop-down list of all views.
function viewChooser(views, onChoose) {
  const select = h('select', {'aria-label': 'Go to a view', onchange: () => onChoose(views.find((view) => String(view.id) === select.value))},
    h('option', {value: ''}, 'Go to a view …'),
    Object.entries(ROLES).map(([role, {plural}]) => {
      const members = views.filter((view) => view.role === role && view.camera);
      return members.length > 0 && h('optgroup', {label: plural}, members.map((view) => h('option', {value: String(view.id)}, view.name)));
    }));
  return {element: h('div', {}, select), select: (view) => { select.value = view ? String(view.id) : ''; }};
}
