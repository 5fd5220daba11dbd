// Words for what a project is doing.
import {duration} from '../shared/format.js';

const NAMES = {
  new: 'Not started', waiting: 'Waiting', running: 'Running', paused: 'Paused', stopped: 'Stopped', failed: 'Failed',
  finished: 'Finished', elsewhere: 'Running elsewhere'};

export const stateName = (state) => NAMES[state] ?? state;
// "SPZ: small, for most viewers" as ["SPZ", "small, for most viewers"]
export const halves = (label) => {
  const at = label.indexOf(': ');
  return at < 0 ? [label, ''] : [label.slice(0, at), label.slice(at + 2)];
};

export const canDo = (project, what) => project.can?.includes(what) ?? false;
export const countOf = (count, one, many = `${one}s`) => `${count.toLocaleString('en')} ${count === 1 ? one : many}`;

// Seconds, roughly: nobody wants to see "3.4 s".
export const span = (seconds) => (seconds < 10 ? `${Math.max(1, Math.round(seconds))} s` : duration(seconds));
export const about = (seconds) => (seconds < 10 ? 'a few seconds' : `about ${duration(seconds)}`);

// One line about where a run is.
export function progressLine({state, progress, message}) {
  if (state === 'failed' || state === 'stopped') return message === 'interrupted' ? '' : message ?? '';  // whoever stopped it knows
  if (state === 'elsewhere') return message || 'Another program is working on this splat.';
  if (!progress) return '';
  if (state === 'waiting') return progress.position > 1 ? `Number ${progress.position} in the queue` : 'Next in the queue';
  const left = state === 'running' && progress.seconds_left > 0 ? `${about(progress.seconds_left)} left` : '';
  return [progress.stage, left].filter(Boolean).join(' · ');
}

export function when(iso) {
  const date = new Date(iso);
  if (Number.isNaN(date.getTime())) return '';
  const today = date.toDateString() === new Date().toDateString();
  return today ? `today, ${date.toLocaleTimeString('en', {timeStyle: 'short'})}` : date.toLocaleDateString('en', {dateStyle: 'medium'});
}
