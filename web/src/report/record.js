// The command that reproduces the run, and the licenses of its parts.
import {h} from '../shared/dom.js';
import {table} from './table.js';

export function commandAndOptions(run) {
  const options = run.options ?? [];
  if (!run.command && options.length === 0) return null;
  const changed = options.filter((option) => option.changed);
  const columns = [{name: 'Option', value: (o) => o.name, cell: (o) => h('code', {}, o.name)}, {name: 'Value', value: (o) => String(o.value), cell: (o) => h('code', {}, String(o.value))}];
  return h('div', {},
    run.command && command(run.command),
    changed.length > 0 && h('div', {}, h('h3', {}, 'Options that differ from their defaults'), h('div', {class: 'card'}, table(changed, columns, {caption: 'Changed options'}))),
    options.length > changed.length && h('details', {}, h('summary', {}, `All ${options.length} options`),
      h('div', {class: 'card'}, table([...changed, ...options.filter((o) => !o.changed)], columns,
        {caption: 'All options', sortable: true, rowClass: (o) => (o.changed ? 'changed' : undefined)}))));
}

function command(text) {
  const pre = h('pre', {tabIndex: 0, 'aria-label': 'The command that reproduces this run'}, text);
  const button = h('button', {type: 'button', 'aria-live': 'polite', onclick: async () => {
    button.textContent = (await copied(text, pre)) ? 'Copied' : 'Selected: copy it with Ctrl+C';
    setTimeout(() => { button.textContent = 'Copy the command'; }, 2500);
  }}, 'Copy the command');
  return h('div', {class: 'command'}, pre, button);
}

// A page opened as a file may not have the clipboard; then the text is selected.
async function copied(text, element) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    getSelection().selectAllChildren(element);
    return false;
  }
}

export function licenses(run) {
  if (!run.licenses?.length) return null;
  return h('div', {class: 'card'}, table(run.licenses, [
    {name: 'Part', value: (l) => l.name}, {name: 'License', value: (l) => l.license}, {name: 'Note', value: (l) => l.note ?? ''}], {caption: 'Licenses'}));
}
