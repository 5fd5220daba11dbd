// What is left out of the splat and how it stands. Kept with the project; every download uses it.
import {h, uniqueId} from '../shared/dom.js';
import {post, projectPath} from './api.js';
import {Choices} from './choices.js';
import {announce, attempt, button, say, setText} from './parts.js';
import {focusOf} from './frames.js';
import {Measure} from './measure.js';
import {canDo, countOf} from './states.js';

const PLAIN = {crop: 'none', up: 'auto', scale: 'auto', min_support: 0, max_uncertainty: 1, remove_outliers: false};

const CROPS = [
  {id: 'none', label: 'Everything'}, {id: 'auto', label: 'What the photos look at', note: 'leaves out the far surroundings'},
  {id: 'box', label: 'A box', note: 'six numbers, or a place in the 3D view'}];
const SUPPORTS = [
  {id: '0', label: 'Keep everything'}, {id: '0.25', label: 'Hide what photos hardly show'}, {id: '0.5', label: 'Hide also what was invented between photos'},
  {id: '0.75', label: 'Keep only what two or more photos show'}];
const UPS = [
  ['auto', 'as other programs expect'], ['y', 'along y'], ['-y', 'against y'], ['z', 'along z'], ['-z', 'against z'], ['x', 'along x'], ['-x', 'against x']];
const CORNERS = [['from', 0], ['to', 3]];
const NAMES = {crop: 'what is kept', up: 'which way is up', scale: 'the size', min_support: 'what is hidden', remove_outliers: 'the specks'};

const same = (a, b) => Object.keys(PLAIN).every((name) => a[name] === b[name]);
const stepsOf = new Map();  // by id of a project: edits before and, after an undo, behind those that are kept

const round = (value) => Number(value.toPrecision(4));

export class Edits {
  // frames: has the 3D view
  constructor(session, id, frames) {
    if (!stepsOf.has(id)) stepsOf.set(id, {past: [], future: []});
    Object.assign(this, {session, frames, steps: stepsOf.get(id), turn: 0, keptAt: 0, sent: Promise.resolve()});  // turn: of the newest change that is being kept
    const save = () => this.save();
    this.crop = new Choices('Keep', CROPS, () => {
      this.showBox();
      if (this.crop.value === 'box' && !this.boxText) this.boxFromView();
      else save();
    }, {stacked: true});
    this.numbers = CORNERS.flatMap(([corner]) => ['x', 'y', 'z'].map((axis) =>
      h('input', {type: 'number', step: 'any', 'aria-label': `${axis}, ${corner}`, onchange: save})));
    this.box = h('div', {class: 'stack box', hidden: true},
      h('div', {class: 'box-grid'}, h('span', {}), ['x', 'y', 'z'].map((axis) => h('span', {class: 'note', 'aria-hidden': 'true'}, axis)),
        CORNERS.map(([corner, at]) => [h('span', {class: 'note', 'aria-hidden': 'true'}, corner), this.numbers.slice(at, at + 3)])),
      h('div', {class: 'row'}, button('Around what the 3D view turns around', () => this.boxFromView()), button('Smaller', () => this.grow(1 / 1.25)), button('Larger', () => this.grow(1.25))),
      h('p', {class: 'note'}, 'Double-click a thing in the 3D view: the view then turns around it.'));
    this.support = new Choices('Hide what photos do not show', SUPPORTS, save, {stacked: true});
    this.specks = h('input', {type: 'checkbox', onchange: save});
    this.up = h('select', {onchange: save}, UPS.map(([value, label]) => h('option', {value}, label)));
    const scaleNote = uniqueId('note');
    this.scale = h('input', {type: 'number', step: 'any', min: '0.000001', max: '1000000', placeholder: 'auto', onchange: save, 'aria-describedby': scaleNote});
    this.measure = new Measure(() => this.focus(), (scale) => {
      this.scale.value = String(round(scale));
      save();
    });
    this.state = h('p', {class: 'note', role: 'status'});
    this.undo = button('Undo', () => this.step('past'), {title: 'Ctrl+Z'});
    this.redo = button('Redo', () => this.step('future'), {title: 'Ctrl+Shift+Z'});
    this.undoAll = button('Undo all of it', () => this.reset());
    this.fields = h('fieldset', {class: 'bare stack'}, h('legend', {class: 'visually-hidden'}, 'Changes'), h('div', {class: 'row'}, this.undo, this.redo, this.undoAll), this.crop.element, this.box, this.support.element,
      h('label', {class: 'check'}, this.specks, h('span', {}, 'Remove specks that float far from the rest')),
      h('label', {class: 'field'}, h('span', {}, 'Which way is up in the file'), this.up), h('p', {class: 'note'}, 'The 3D view shows it upright in any case.'),
      h('label', {class: 'field'}, h('span', {}, 'Make it this many times as large'), this.scale),
      h('p', {class: 'note', id: scaleNote}, 'Empty: as it is, or in meters where the photos tell.'), this.measure.element);
    this.fields.addEventListener('input', () => this.preview());
    this.element = h('section', {class: 'card', 'aria-label': 'Change'}, h('details', {class: 'fold-card'},
      h('summary', {}, h('h2', {}, 'Change'), h('span', {class: 'note'}, 'cut out, clean, turn, scale')),
      h('div', {class: 'stack'}, h('p', {class: 'note'}, 'The splat itself stays as it is. Every file that you download is changed like this, and the 3D view shows it.'), this.fields, this.state)));
    this.listener = (event) => this.key(event);
    document.addEventListener('keydown', this.listener);
    frames.onViewKey = this.listener;
  }

  close() {
    document.removeEventListener('keydown', this.listener);
  }

  // Fields that one types in undo by themselves.
  key(event) {
    const typing = event.target.closest?.('input:not([type=radio]):not([type=checkbox]), textarea');
    if (!(event.ctrlKey || event.metaKey) || event.altKey || event.key.toLowerCase() !== 'z' || typing) return;
    if (this.element.hidden || document.querySelector('dialog[open]')) return;
    event.preventDefault();
    this.step(event.shiftKey ? 'future' : 'past');
  }

  focus() {
    return focusOf(this.frames.viewFrame);
  }

  update(project) {
    this.project = project;
    this.element.hidden = !canDo(project, 'edit');
    const edits = {...PLAIN, ...project.edits};
    const key = JSON.stringify(edits);
    if (key === this.known || this.turn > 0 || project.asked < this.keptAt) return;
    this.known = key;
    this.show(edits);
  }

  show(edits) {
    const box = /^box:(.*)$/.exec(edits.crop);
    this.crop.value = box ? 'box' : edits.crop;
    this.wanted = edits;
    if (box) this.fillBox(box[1].split(',').map(Number));
    this.support.value = String([0.75, 0.5, 0.25, 0].find((step) => edits.min_support >= step));
    this.specks.checked = Boolean(edits.remove_outliers);
    this.up.value = edits.up;
    this.scale.value = edits.scale === 'auto' ? '' : String(edits.scale);
    this.showBox();
    this.frames.preview(edits);
    this.showState(edits);
  }

  showState(edits) {
    this.edits = edits;
    const changed = !same(edits, PLAIN);
    this.undoAll.setAttribute('aria-disabled', String(!changed));
    this.undo.setAttribute('aria-disabled', String(this.steps.past.length === 0));
    this.redo.setAttribute('aria-disabled', String(this.steps.future.length === 0));
    setText(this.state, changed ? 'Kept: every download from now on is changed like this.' : '');
  }

  showBox() {
    this.box.hidden = this.crop.value !== 'box';
  }

  fillBox(values) {
    values.forEach((value, i) => { this.numbers[i].value = String(value); });
  }

  // "x0,y0,z0,x1,y1,z1", or '' while a number is missing.
  get boxText() {
    const values = this.numbers.map(({value}) => (value === '' ? NaN : Number(value)));
    if (!values.every(Number.isFinite)) return '';
    const low = [0, 1, 2].map((k) => Math.min(values[k], values[k + 3]));
    const high = [0, 1, 2].map((k) => Math.max(values[k], values[k + 3]));
    return [...low, ...high].join(',');
  }

  boxFromView() {
    const focus = this.focus();
    if (!focus) {
      setText(this.state, 'Type the six numbers, or wait until the 3D view is there.');
      return;
    }
    const half = focus.distance / 2;
    this.fillBox([...focus.point.map((v) => round(v - half)), ...focus.point.map((v) => round(v + half))]);
    this.save();
  }

  grow(factor) {
    const values = this.boxText.split(',').map(Number);
    if (values.length < 6) return;
    const [low, high] = [values.slice(0, 3), values.slice(3)];
    const part = (sign) => low.map((v, k) => round((v + high[k]) / 2 + (sign * factor * (high[k] - v)) / 2));
    this.fillBox([...part(-1), ...part(1)]);
    this.save();
  }

  read() {
    const crop = this.crop.value === 'box' ? this.boxText && `box:${this.boxText}` : this.crop.value;
    const scale = this.scale.value === '' ? 'auto' : Number(this.scale.value);
    return {...this.edits, crop: crop || 'none', up: this.up.value, scale, min_support: Number(this.support.value), remove_outliers: this.specks.checked};
  }

  // In the 3D view, while somebody types or chooses.
  preview() {
    if (this.crop.value !== 'box' || this.boxText) this.frames.preview(this.read());
  }

  save(edits = this.read()) {
    if (this.crop.value === 'box' && edits.crop === 'none') return undefined;  // not all numbers are there yet
    if (same(edits, this.wanted)) return undefined;
    this.steps.past.push(this.wanted);
    this.steps.future.length = 0;
    return this.keep(edits);
  }

  // One step back ("past") or forth ("future").
  step(way) {
    const {[way]: from, [way === 'past' ? 'future' : 'past']: to} = this.steps;
    while (from.length > 0 && same(from.at(-1), this.wanted)) from.pop();  // could not be kept
    const edits = from.pop();
    if (!edits) {
      announce(way === 'past' ? 'There is nothing to undo.' : 'There is nothing to redo.');
      return;
    }
    const changed = Object.keys(NAMES).filter((name) => edits[name] !== this.wanted[name]).map((name) => NAMES[name]);
    to.push(this.wanted);
    this.show(edits);
    this.keep(edits);
    announce(`${way === 'past' ? 'Undone' : 'Redone'}: ${changed.join(', ')}. ${countOf(from.length, 'more step')} to ${way === 'past' ? 'undo' : 'redo'}.`);
  }

  async keep(edits) {
    this.wanted = edits;
    this.frames.preview(edits);
    const turn = ++this.turn;
    this.sent = this.sent.then(() => attempt(() => post(projectPath(this.project.id, 'edits'), edits)));
    const kept = await this.sent;
    if (turn !== this.turn) return kept;  // something else was changed meanwhile
    this.turn = 0;
    this.keptAt = performance.now();
    if (kept) this.known = JSON.stringify({...PLAIN, ...edits});
    if (kept) this.showState(edits);  // the fields show it; somebody may be typing in them
    else this.show(JSON.parse(this.known));
    this.session.poll();
    return kept;
  }

  async reset() {
    if (this.undoAll.getAttribute('aria-disabled') === 'true') return;
    this.steps.past.push(this.wanted);
    this.steps.future.length = 0;
    this.show({...PLAIN});
    if (await this.keep({...PLAIN})) say('All changes are undone.');
  }
}
