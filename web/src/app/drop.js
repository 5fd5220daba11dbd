// Files that are dropped or chosen, folders with all that is in them.
import {h} from '../shared/dom.js';
import {button} from './parts.js';

export const MOST_FILES = 10000;  // of a project; a whole disk dropped by mistake ends here, too

const wanted = (name) => !name.startsWith('.') && name !== 'Thumbs.db' && name !== 'desktop.ini';

async function filesIn(entry, out) {
  if (out.length > MOST_FILES || !wanted(entry.name) || entry.name === '__MACOSX') return;
  if (entry.isFile) {
    out.push(await new Promise((done, fail) => entry.file(done, fail)));
    return;
  }
  const reader = entry.createReader();
  for (;;) {  // a reader gives up to 100 at a time
    const entries = await new Promise((done, fail) => reader.readEntries(done, fail));
    if (entries.length === 0) return;
    for (const inner of entries) await filesIn(inner, out);
  }
}

// {files, name}: name of a lone folder, zip or video, else ''.
async function gather(transfer) {
  const entries = [...transfer.items].filter(({kind}) => kind === 'file').map((item) => [item.webkitGetAsEntry?.(), item.getAsFile()]);
  const files = [];
  for (const [entry, file] of entries) {
    if (entry) await filesIn(entry, files).catch(() => file && files.push(file));
    else if (file) files.push(file);
  }
  return {files, name: entries.length === 1 && entries[0][0]?.isDirectory ? entries[0][0].name : nameOf(files)};
}

const nameOf = (files) => (files.length === 1 && !files[0].type.startsWith('image/') ? files[0].name.replace(/\.[^.]*$/, '') : '');

// The whole window takes files. take({files, name}): what to do with them.
export function listenForDrops(take) {
  const veil = h('div', {class: 'veil', hidden: true, 'aria-hidden': 'true'}, h('p', {}, 'Drop photos, a folder, a zip or a video'));
  document.body.append(veil);
  let depth = 0;
  const holdsFiles = (event) => event.dataTransfer?.types.includes('Files');
  const show = (shown) => { veil.hidden = !shown; };
  window.addEventListener('dragenter', (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    depth++;
    show(true);
  });
  window.addEventListener('dragover', (event) => holdsFiles(event) && event.preventDefault());
  window.addEventListener('dragleave', () => show(--depth > 0));
  window.addEventListener('drop', async (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    depth = 0;
    show(false);
    take(await gather(event.dataTransfer));
  });
}

// Two buttons that open the system's dialogs.
export function chooser(take, label = 'Choose photos', primary = true) {
  const input = (props) => {
    const element = h('input', {type: 'file', class: 'visually-hidden', tabindex: '-1', 'aria-hidden': 'true', multiple: true, ...props});
    element.addEventListener('change', () => {
      const files = [...element.files].filter(({name}) => wanted(name));
      const folder = files[0]?.webkitRelativePath.split('/')[0];
      element.value = '';
      if (files.length) take({files, name: folder || nameOf(files)});
    });
    return element;
  };
  const photos = input({accept: 'image/*,video/*,.zip,.heic,.heif', 'data-choose': 'files'});
  const folder = input({'data-choose': 'folder'});
  folder.webkitdirectory = true;
  return h('div', {class: 'row'}, photos, folder,
    button(label, () => photos.click(), {class: primary ? 'primary' : ''}), button('Choose a folder', () => folder.click()));
}

export function dropZone(take, ...texts) {
  return h('div', {class: 'drop'}, h('p', {class: 'drop-title'}, 'Drop photos here'), chooser(take), texts.map((text) => h('p', {class: 'note'}, text)));
}
