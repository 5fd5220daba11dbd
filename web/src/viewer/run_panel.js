// How the run is going: stages with the time they still need, curves, warnings.
import {h, fill} from '../shared/dom.js';
import {duration, number} from '../shared/format.js';
import {Chart} from '../ui/chart.js';

const STATES = {running: 'Running', finished: 'Finished', failed: 'Failed', interrupted: 'Stopped', ended: 'Ended'};

export class RunPanel {
  constructor() {
    this.state = h('p', {class: 'note', role: 'status'});
    this.stages = h('ol', {class: 'stages'});
    this.curves = h('details', {class: 'curves', hidden: true}, h('summary', {}, 'Curves'));
    this.warnings = h('div', {class: 'warnings'});
    this.element = h('section', {class: 'panel run', hidden: true, 'aria-label': 'Progress of the run'},
      h('h2', {}, 'Run'), this.state, this.stages, this.curves, this.warnings);
    this.charts = new Map();
  }

  update(live) {
    this.element.hidden = !live;
    if (!live) return;
    this.state.textContent = sentence(live);
    fill(this.stages, (live.stages ?? []).map(stageItem));
    this.stages.hidden = !live.stages?.length;
    this.drawCurves((live.curves ?? []).filter((curve) => curve.x?.length > 1));
    fill(this.warnings, (live.warnings ?? []).slice(-5).map((text) => h('p', {class: 'warning'}, text)));
  }

  drawCurves(curves) {
    if (curves.length > 0) this.curves.hidden = false;
    for (const curve of curves) {
      const chart = this.charts.get(curve.name);
      if (chart) {
        chart.set([curve]);
      } else {
        const made = new Chart([curve], {height: 170, logarithmic: curve.name === 'loss'});
        this.charts.set(curve.name, made);
        this.curves.append(h('h3', {class: 'note'}, curve.name), made.element);
      }
    }
  }
}

export const stateName = (live) => STATES[live?.state] ?? '';

function sentence(live) {
  const elapsed = Number.isFinite(live.elapsed_seconds) ? ` after ${duration(live.elapsed_seconds)}` : '';
  const message = live.message ? ` ${live.message}` : '';
  if (live.state === 'ended') return 'The program no longer answers; this is what it said last.';
  if (live.state === 'failed') return `The run failed${elapsed}.${message}`;
  if (live.state === 'interrupted') return `The run was stopped${elapsed}; the same command continues it.${message}`;
  if (live.state === 'finished') return `The run ended${elapsed}.${message}`;
  const left = live.left_seconds > 0 ? `, about ${duration(live.left_seconds)} left` : '';
  return `Running for ${duration(live.elapsed_seconds)}${left}.${message}`;
}

function stageItem(stage) {
  const share = stage.total > 0 ? stage.done / stage.total : undefined;
  const running = stage.state === 'running';
  const planned = stage.state === 'planned';
  const time = stage.state === 'unchanged' ? 'unchanged' : planned && !(stage.seconds > 0) ? '' : `${planned ? 'about ' : ''}${duration(stage.seconds)}`;
  const what = running && [
    stage.total > 0 && `${number(stage.done)} of ${number(stage.total)} ${stage.unit ?? ''}`.trim(), stage.detail,
    Number.isFinite(stage.eta_seconds) && `about ${duration(stage.eta_seconds)} left`].filter(Boolean).join(' · ');
  return h('li', {'data-state': stage.state}, h('span', {class: 'mark', 'aria-hidden': 'true'}),
    h('span', {}, stage.name, h('span', {class: 'visually-hidden'}, `, ${stage.state}`)), h('span', {class: 'time'}, time),
    running && h('progress', {max: 1, value: share, 'aria-label': `Progress of ${stage.name}`}),
    what && h('span', {class: 'what'}, what));
}
