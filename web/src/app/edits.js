// What is left out of the splat and how it stands. Kept with the project; every download uses it.
import {h, uniqueId} from '../shared/dom.js';
import {post, projectPath} from './api.js';
import {Choices} from './choices.js';
import {attempt, button, say, setText} from './parts.js';
import {focusOf} from './frames.js';
import {Measure} from './measure.js';
import {canDo} from './states.js';

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

const round = (value) => Number(value.toPrecision(4));

export class Edits {
  // frames: has the 3D view
  constructor(session, frames) {
    Object.assign(this, {session, frames, turn: 0, keptAt: 0, sent: Promise.resolve()});  // turn: of the newest change that is being kept
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
    this.undo = button('Undo all of it', () => this.reset());
    this.fields = h('fieldset', {class: 'bare stack'}, h('legend', {class: 'visually-hidden'}, 'Changes'), this.crop.element, this.box, this.support.element,
      h('label', {class: 'check'}, this.specks, h('span', {}, 'Remove specks that float far from the rest')),
      h('label', {class: 'field'}, h('span', {}, 'Which way is up'), this.up),
      h('label', {class: 'field'}, h('span', {}, 'Make it this many times as large'), this.scale),
      h('p', {class: 'note', id: scaleNote}, 'Empty: as it is, or in meters where the photos tell.'), this.measure.element, this.undo);
    this.element = h('section', {class: 'card', 'aria-label': 'Change'}, h('details', {class: 'fold-card'},
      h('summary', {}, h('h2', {}, 'Change'), h('span', {class: 'note'}, 'cut out, clean, turn, scale')),
      h('div', {class: 'stack'}, h('p', {class: 'note'}, 'The splat itself stays as it is. Every file that you download is changed like this.'), this.fields, this.state)));
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
    if (box) this.fillBox(box[1].split(',').map(Number));
    this.support.value = String([0.75, 0.5, 0.25, 0].find((step) => edits.min_support >= step));
    this.specks.checked = Boolean(edits.remove_outliers);
    this.up.value = edits.up;
    this.scale.value = edits.scale === 'auto' ? '' : String(edits.scale);
    this.showBox();
    this.showState(edits);
  }

  showState(edits) {
    this.edits = edits;
    const changed = Object.keys(PLAIN).some((name) => edits[name] !== PLAIN[name]);
    this.undo.setAttribute('aria-disabled', String(!changed));
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

  async save(edits = this.read()) {
    if (this.crop.value === 'box' && edits.crop === 'none') return;  // not all numbers are there yet
    const turn = ++this.turn;
    this.sent = this.sent.then(() => attempt(() => post(projectPath(this.project.id, 'edits'), edits)));
    const kept = await this.sent;
    if (turn !== this.turn) return;  // something else was changed meanwhile
    this.turn = 0;
    this.keptAt = performance.now();
    if (kept) this.known = JSON.stringify({...PLAIN, ...edits});
    if (kept) this.showState(edits);  // the fields show it; somebody may be typing in them
    else this.show(this.edits);
    this.session.poll();
  }

  async reset() {
    if (this.undo.getAttribute('aria-disabled') === 'true') return;
    this.numbers.forEach((input) => { input.value = ''; });
    this.show({...PLAIN});
    await this.save({...PLAIN});
    say('All changes are undone.');
  }
}
