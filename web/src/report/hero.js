// The top of the page: an image, what it is, and what went wrong.
import {h} from '../shared/dom.js';
import {bytes, fileName, number} from '../shared/format.js';

export function hero(run) {
  const views = (role) => (run.views ?? []).filter((view) => view.role === role).length;
  const facts = [
    views('train') && `${views('train')} training views`, views('test') && `${views('test')} test views`,
    views('proposal') && `${views('proposal')} invented views`, run.splat?.gaussians && `${number(run.splat.gaussians)} Gaussians`,
    Number.isFinite(run.scores?.psnr) && `PSNR ${number(run.scores.psnr, 2)} dB`].filter(Boolean);
  const image = run.hero?.url && h('img', {src: run.hero.url, alt: run.hero.caption || `Render of ${run.title ?? 'the scene'}`});
  return h('header', {class: image ? 'hero' : 'hero bare'},
    image,
    h('div', {class: 'hero-text'}, h('h1', {}, run.title ?? 'OracleGS'), h('p', {}, facts.join(' · ')),
      run.hero?.caption && h('p', {}, run.hero.caption), download(run)));
}

// The splat lies inside the page: it can be taken out without the program.
function download({splat, title}) {
  if (!splat?.url) return null;
  return h('p', {}, h('a', {class: 'button', href: splat.url, download: fileName(title, splat.format ?? 'spz')}, `Download the splat (${(splat.format ?? 'spz').toUpperCase()}${splat.bytes ? `, ${bytes(splat.bytes)}` : ''})`));
}

export function film(run) {
  if (!run.video?.url) return null;
  return h('video', {class: 'film', controls: true, loop: true, muted: true, playsInline: true, preload: 'metadata', src: run.video.url, 'aria-label': 'An orbit around the scene'});
}

export function warnings(run) {
  const texts = [...(run.warnings ?? [])];
  if (run.unfinished) texts.unshift(`The run was stopped: this is its ${run.unfinished}. The command that began it goes on.`);
  if (run.finished === false) texts.unshift('The run has not finished: the same command continues it.');
  if (run.non_commercial?.length) texts.push(`For non-commercial use only: made with ${run.non_commercial.join(', ')}.`);
  return texts.length > 0 && h('div', {class: 'warnings', role: 'note', 'aria-label': 'Warnings'}, texts.map((text) => h('p', {class: 'warning'}, text)));
}
