// Curves with uPlot: axes, a legend that follows the pointer, the page's colors.
import uPlot from 'uplot';
import {h} from '../shared/dom.js';
import {short} from '../shared/format.js';

const LINES = ['--chart-1', '--chart-2', '--chart-3', '--chart-4'];

export class Chart {
  // curves: [{name, unit, x_name, x, y}], all over the same kind of x; logarithmic: the y axis; points: marks, too;
  // extra: [{x, y, label}] further lines without marks
  constructor(curves, {logarithmic = false, points = false, yName, range, height = 220} = {}) {
    Object.assign(this, {logarithmic, points, yName, range, height});
    this.element = h('div', {class: 'chart', role: 'img'});
    this.set(curves);
    new ResizeObserver(() => this.resize()).observe(this.element);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.plot?.redraw());
  }

  set(curves) {
    this.curves = curves;
    this.element.setAttribute('aria-label', curves.map(describe).join('. '));
    const shape = curves.map((c) => c.name).join('|');
    if (this.plot && shape === this.shape) {
      this.plot.setData(joined(curves, this.logarithmic));
      return;
    }
    this.shape = shape;
    this.plot?.destroy();
    this.plot = undefined;
    this.resize();
  }

  resize() {
    const width = Math.floor(this.element.clientWidth);
    if (width <= 0) return;
    if (this.plot) {
      if (width !== this.plot.width) this.plot.setSize({width, height: this.height});
      return;
    }
    this.plot = new uPlot(this.options(width), joined(this.curves, this.logarithmic), this.element);
  }

  color(name) {
    return getComputedStyle(this.element).getPropertyValue(name).trim();
  }

  options(width) {
    const axis = (label) => ({
      stroke: () => this.color('--text-dim'), grid: {stroke: () => this.color('--line'), width: 1}, ticks: {show: false},
      font: '12px system-ui, sans-serif', labelFont: '12px system-ui, sans-serif', label, labelSize: 16, labelGap: 0,
      values: (_, splits) => splits.map((v) => (v === null ? '' : short(v)))});
    const value = (_, v) => (v === null || v === undefined ? '–' : short(v));
    return {
      width, height: this.height, cursor: {drag: {x: true, y: false}}, legend: {live: true},
      scales: {x: {time: false, range: this.range?.x}, y: {distr: this.logarithmic ? 3 : 1, range: this.range?.y}},
      axes: [{...axis(this.curves[0].x_name ?? ''), size: 30}, {...axis(this.yName), size: 52}],
      series: [
        {label: this.curves[0].x_name ?? 'x', value},
        ...this.curves.map((curve, i) => ({
          label: curve.unit ? `${curve.name} (${curve.unit})` : curve.name, value, width: 1.75, dash: curve.dash, spanGaps: true,
          stroke: () => this.color(LINES[i % LINES.length]), points: {show: this.points && !curve.dash, size: 7}})),
      ],
    };
  }
}

// uPlot wants one x for all series.
function joined(curves, positive) {
  const clean = (v) => (Number.isFinite(v) && (!positive || v > 0) ? v : null);
  const tables = curves.map((c) => [Array.from(c.x, Number), Array.from(c.y, clean)]);
  return tables.length === 1 ? tables[0] : uPlot.join(tables);
}

function describe({name, unit, x_name, x, y}) {
  const finite = Array.from(y).filter(Number.isFinite);
  if (finite.length === 0) return `${name}: no values yet`;
  return `${name}${unit ? ` in ${unit}` : ''} over ${x_name ?? 'x'}, ${x.length} values: starts at ${short(finite[0])}, `
    + `ends at ${short(finite[finite.length - 1])}, lowest ${short(finite.reduce((a, b) => Math.min(a, b)))}`;
}
