// Which splat the page shows: while training the newest snapshot, afterwards the final one with what is known of its Gaussians.
import {splatOf} from '../shared/bytes.js';
import {fileUrl} from './session.js';

export class SplatSource {
  // onState(text or ''): what the page says in place of a splat; onShown(): another splat is there.
  constructor(scene, onState, onShown) {
    Object.assign(this, {scene, onState, onShown, shown: undefined, loading: undefined});
  }

  wanted({document: run, live}) {
    const final = run?.splat?.url && {...run.splat, key: `final ${run.splat.url} ${run.splat.bytes} ${run.splat.gaussians} ${run.created}`};
    const snapshot = live?.splat?.url && {
      url: live.splat.url, format: live.splat.url.split('.').pop(), key: `live ${live.started} ${live.splat.of} ${live.splat.iteration} ${live.splat.gaussians}`};
    return live?.state === 'running' ? snapshot || final : final || snapshot;
  }

  async update(session) {
    const wanted = this.wanted(session);
    if (!wanted) {
      if (!this.shown) this.onState(waiting(session));
      return;
    }
    if (wanted.key === this.shown || this.loading) return;
    this.loading = wanted.key;
    try {
      if (!this.shown) this.onState('Loading the splat …');
      await this.scene.setSplat(await splatOf(wanted, fileUrl));
      this.shown = wanted.key;
      this.isLive = wanted.key.startsWith('live');
      this.onState('');
      this.onShown(wanted);
    } catch (error) {
      if (!this.shown) this.onState(`The splat cannot be shown: ${error.message}`);
    }
    this.loading = undefined;
  }
}

// What the page says before there is anything in 3D.
function waiting({document: run, running}) {
  if (!running) return 'There is no splat yet.';
  if (run?.views?.some((view) => view.camera)) return '';  // the cameras are there
  return 'The program looks for where the photos were taken. Cameras, points and the splat appear here as they are found.';
}
