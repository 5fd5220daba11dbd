// The keys of the page. The 3D view has its own (scene/controls.js); the list of views, too.
import {h} from '../shared/dom.js';

const HELP = [
  ['drag · one finger', 'turn around the scene'], ['right button, Shift + drag · two fingers', 'move'],
  ['wheel · pinch', 'go nearer, go away'], ['double click', 'turn around what is there'], ['click a camera', 'fly there and compare with its image'],
  ['← → ↑ ↓', 'turn (3D view), choose (list of views)'], ['W A S D, Q E', 'walk, down and up; with Shift faster'], ['+ −', 'nearer, away'],
  ['N B', 'next view, the one before'], ['M', 'show color, provenance, depth or normals'], ['P', 'show provenance: colors by support'], ['I', 'save the 3D view as an image'], ['C', 'show or hide the cameras'],
  ['H', 'back to the first camera'], ['U', 'another axis is up, for files without cameras'], ['F', 'full screen'], ['Esc', 'end the comparison'], ['?', 'this help']];

// actions: {key: function}, keys in lower case. Typing in a field is left alone.
export function listenForKeys(actions) {
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector('dialog[open]')) return;
    if (event.target.closest?.('input:not([type=range]):not([type=checkbox]):not([type=radio]), textarea, select')) return;
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (action) {
      event.preventDefault();
      action();
    }
  });
}

export function helpDialog() {
  const dialog = h('dialog', {'aria-label': 'Keys and gestures'},
    h('h2', {}, 'Keys and gestures'),
    h('table', {}, h('tbody', {}, HELP.map(([keys, what]) => h('tr', {}, h('td', {}, keys), h('td', {}, what))))),
    h('button', {type: 'button', class: 'primary', onclick: () => dialog.close()}, 'Close'));
  return dialog;
}
