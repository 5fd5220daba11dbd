// How the work goes: what is done, what is left, and what one can do about it.
import {fill, h} from '../shared/dom.js';
import {percent} from '../shared/format.js';
import {announce, button, refill, setText} from './parts.js';
import {change} from './project_actions.js';
import {about, canDo, progressLine, span, stateName} from './states.js';

const WORDS = {done: 'done', running: 'going on', todo: 'to come'};
const HINTS = {
  waiting: 'It starts by itself when those before it are done.', running: '', paused: 'The splat so far is kept. Resume when you like.',
  stopped: 'The best splat so far is kept.', elsewhere: 'This page shows how it goes and can change nothing until that program has ended.'};

export class ProgressPanel {
  constructor(session) {
    this.session = session;
    this.heading = h('h2', {});
    this.line = h('p', {class: 'progress-line'});
    this.bar = h('progress', {max: 1, 'aria-label': 'Progress of everything'});
    this.share = h('span', {class: 'note'});
    this.failure = h('div', {class: 'failure', role: 'alert', hidden: true});
    this.hint = h('p', {class: 'note'});
    this.safe = h('p', {class: 'note'}, 'You can close this page, or the browser: the work goes on, and the page finds it again.');
    const tool = (label, action) => [action, button(label, () => change(session, this.project, action))];
    this.tools = new Map([tool('Pause', 'pause'), tool('Resume', 'resume'), tool('Stop', 'stop')]);
    this.stages = h('ol', {class: 'stage-list'});
    this.warnings = h('div', {class: 'stack'});
    this.log = h('pre', {tabIndex: 0, 'aria-label': 'What the program printed'});
    this.details = h('details', {hidden: true}, h('summary', {}, 'What the program says'), this.log);
    this.element = h('section', {class: 'card stack', 'aria-label': 'Progress'}, this.heading, this.failure,
      this.line, h('div', {class: 'bar-row'}, this.bar, this.share), h('div', {class: 'row'}, [...this.tools.values()]), this.hint, this.safe,
      this.stages, this.warnings, this.details);
  }

  update(project) {
    const {state, progress, stages = [], warnings = [], log = []} = project;
    this.project = project;
    this.element.hidden = state === 'new' || (state === 'finished' && warnings.length + stages.length + log.length === 0);
    setText(this.heading, ['finished', 'stopped', 'failed'].includes(state) ? 'How it went' : 'Progress');
    const active = ['running', 'paused', 'waiting', 'elsewhere'].includes(state);
    setText(this.line, state === 'failed' ? '' : progressLine(project));
    this.line.hidden = !this.line.textContent;
    this.bar.parentElement.hidden = !progress || !active || state === 'waiting';
    if (progress) this.bar.value = progress.share ?? 0;
    setText(this.share, progress?.share > 0 ? percent(progress.share) : '');
    refill(this.failure, state === 'failed' && project.message, (message) => [
      h('h3', {}, 'This is why it ended'), h('p', {}, message || 'The program did not say why; see “What the program says” below.')]);
    this.failure.hidden = state !== 'failed';
    for (const [action, element] of this.tools) element.hidden = !canDo(project, action);
    setText(this.hint, HINTS[state] ?? '');
    this.hint.hidden = !this.hint.textContent;
    this.safe.hidden = !['running', 'waiting'].includes(state);
    refill(this.stages, stages, (all) => all.map(stageItem));
    refill(this.warnings, warnings, (all) => all.slice(-8).map((text) => h('p', {class: 'warning'}, text)));
    this.details.hidden = log.length === 0;
    this.showLog(log.join('\n'));
    this.tell(project);
  }

  // Stays at its end unless somebody reads further up.
  showLog(text) {
    if (this.log.textContent === text) return;
    const atEnd = this.log.scrollHeight - this.log.scrollTop - this.log.clientHeight < 30;
    fill(this.log, text);
    if (atEnd) this.log.scrollTop = this.log.scrollHeight;
  }

  // A screen reader hears of another stage or state, not of each percent.
  tell({state, progress, message}) {
    const stage = state === 'running' ? (progress?.stage ?? '') : '';
    const key = `${state} ${stage}`;
    if (this.told && this.told !== key) announce(stage ? `${stage}, ${percent(progress.share)} of everything done` : `${stateName(state)}. ${message ?? ''}`);
    this.told = key;
  }
}

function stageItem({label, state, seconds, seconds_left: left}) {
  const ahead = left > 0 ? left : seconds;  // of one that has not begun
  const time = {running: left > 0 && `${about(left)} left`, done: seconds >= 0 && span(seconds), todo: ahead > 0 && about(ahead)}[state] || '';
  return h('li', {'data-state': state}, h('span', {class: 'mark', 'aria-hidden': 'true'}),
    h('span', {}, label, h('span', {class: 'visually-hidden'}, `, ${WORDS[state] ?? state}`)), h('span', {class: 'time'}, time));
}
