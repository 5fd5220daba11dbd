// Small pieces that several pages use. Updates change only what differs: focus, scroll and selections stay.
import {fill, h} from '../shared/dom.js';

export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

// Fills the element when the value is another than last time; make(value) returns children.
export function refill(element, value, make) {
  const described = JSON.stringify(value ?? null);
  if (element.described === described) return;
  element.described = described;
  fill(element, make(value));
}

// A function that does the work once, a moment after the first of many calls.
export function soon(work) {
  let waits = false;
  return () => {
    if (waits) return;
    waits = true;
    setTimeout(() => {
      waits = false;
      work();
    }, 100);
  };
}

export const button = (label, onclick, props = {}) => h('button', {type: 'button', onclick, ...props}, label);

// A short word at the lower edge, which screen readers say, too.
const notes = h('div', {class: 'toasts', role: 'status'});
const alarms = h('div', {class: 'toasts', role: 'alert'});
export const toasts = h('div', {class: 'toast-area'}, alarms, notes);

export function say(text, {bad = false} = {}) {
  const toast = h('p', {class: bad ? 'toast bad' : 'toast'}, text, button('×', () => toast.remove(), {class: 'plain', 'aria-label': 'Close this message'}));
  (bad ? alarms : notes).append(toast);
  setTimeout(() => toast.remove(), bad ? 15000 : 6000);
}

// Does something and says why it did not work. The result, or undefined.
export async function attempt(work) {
  try {
    return await work();
  } catch (error) {
    say(error.message, {bad: true});
    return undefined;
  }
}

// One line, said once, that is not shown.
const live = h('p', {class: 'visually-hidden', role: 'status'});
export const announcer = live;
export const announce = (text) => setText(live, text);

// Asks in a dialog. value: a text to change. The new text, true, or null when it was called off.
export function ask({title, text, label, value, yes, danger = false}) {
  return new Promise((resolve) => {
    let answer = null;
    const input = value !== undefined && h('input', {type: 'text', value, maxlength: '200', autocomplete: 'off', required: true});
    const form = h('form', {onsubmit: (event) => {
      event.preventDefault();
      answer = input ? input.value.trim() : true;
      if (answer) dialog.close();
    }}, h('h2', {}, title), text && h('p', {}, text), input && h('label', {class: 'field'}, h('span', {}, label), input),
    h('div', {class: 'row end'}, button('Cancel', () => dialog.close()),
      h('button', {type: 'submit', class: danger ? 'danger' : 'primary'}, yes)));
    const dialog = h('dialog', {'aria-label': title, onclose: () => {
      dialog.remove();
      resolve(answer);
    }}, form);
    document.body.append(dialog);
    dialog.showModal();
    if (input) input.select();
  });
}
