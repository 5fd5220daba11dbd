// Tables whose columns sort.
import {h, fill} from '../shared/dom.js';

// columns: [{name, value(row): number or text, cell(row): what is shown, number: right-aligned}]; caption: for screen readers.
export function table(rows, columns, {caption, sortable = false, rowClass} = {}) {
  const body = h('tbody');
  const show = (ordered) => fill(body, ordered.map((row) => h('tr', {class: rowClass?.(row)},
    columns.map((c) => h('td', {class: c.number && 'number'}, (c.cell ?? c.value)(row))))));
  const heads = columns.map((column) => {
    const head = h('th', {scope: 'col', class: column.number && 'number'}, sortable ? h('button', {type: 'button', onclick: () => sort(column, head)}, column.name) : column.name);
    return head;
  });
  function sort(column, head) {
    const direction = head.getAttribute('aria-sort') === 'ascending' ? 'descending' : 'ascending';
    for (const other of heads) other.removeAttribute('aria-sort');
    head.setAttribute('aria-sort', direction);
    const sign = direction === 'ascending' ? 1 : -1;
    show([...rows].sort((a, b) => sign * compare(column.value(a), column.value(b))));
  }
  show(rows);
  return h('div', {class: 'scroll'}, h('table', {}, caption && h('caption', {class: 'visually-hidden'}, caption), h('thead', {}, h('tr', {}, heads)), body));
}

// Numbers by size, texts by the alphabet, what is missing last.
function compare(a, b) {
  const missing = (v) => v === undefined || v === null || Number.isNaN(v);
  if (missing(a) || missing(b)) return Number(missing(a)) - Number(missing(b));
  return typeof a === 'number' && typeof b === 'number' ? a - b : String(a).localeCompare(String(b), 'en', {numeric: true});
}
