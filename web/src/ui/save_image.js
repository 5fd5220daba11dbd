// Saves the 3D view as a PNG of as many pixels as it has on the screen.
import {h} from '../shared/dom.js';
import {fileName} from '../shared/format.js';

export async function saveImage(scene, title) {
  const blob = await scene.image();
  if (!blob) return;
  const url = URL.createObjectURL(blob);
  h('a', {href: url, download: fileName(title, 'png')}).click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);  // the browser reads it after the click
}
