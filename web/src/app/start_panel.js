// The questions before a start: name, quality, and the device where there is more than one.
import {fill, h} from '../shared/dom.js';
import {bytes} from '../shared/format.js';
import {post, projectPath} from './api.js';
import {Choices} from './choices.js';
import {attempt, setText, soon} from './parts.js';
import {about, canDo, halves} from './states.js';

// What the button says, and the line above it, by state.
const WORDS = {
  new: ['Make the splat', 'Make a splat', ''],
  stopped: ['Continue', 'Continue', 'What was computed so far is kept.'],
  failed: ['Try again', 'Try again', 'Stages that were finished are kept. Remove the photos that are named, or add others, then try again.'],
  finished: ['Go on', 'More photos or a higher quality', 'Add photos or choose a higher quality; the work goes on from what is there.'],
};

export class StartPanel {
  // adder: what adds photos
  constructor(session, uploads, adder) {
    Object.assign(this, {session, uploads, adder, waiting: false});
    this.name = h('input', {type: 'text', maxlength: '200', autocomplete: 'off', onchange: () => this.rename()});
    this.nameField = h('label', {class: 'field'}, h('span', {}, 'Name'), this.name);
    this.heading = h('h2', {});
    this.lead = h('p', {class: 'note'});
    this.questions = h('div', {class: 'stack'});
    this.estimate = h('p', {class: 'estimate'});
    this.problem = h('p', {class: 'problem', role: 'alert', hidden: true});
    this.go = h('button', {type: 'submit', class: 'primary wide'});
    this.element = h('section', {class: 'card', 'aria-label': 'Start'}, h('form', {class: 'stack', onsubmit: (event) => {
      event.preventDefault();
      this.start();
    }}, this.heading, this.lead, this.adder, this.nameField, this.questions, this.estimate, this.problem, this.go));
    this.onItem = soon(() => this.update(this.project));
    this.onIdle = () => this.waiting && this.start();
    uploads.addEventListener('item', this.onItem);
    uploads.addEventListener('idle', this.onIdle);
  }

  close() {
    this.uploads.removeEventListener('item', this.onItem);
    this.uploads.removeEventListener('idle', this.onIdle);
  }

  update(project) {
    this.project = project;
    const {library} = this.session;
    if (!project || !library) return;
    const [verb, heading, lead] = WORDS[project.state] ?? WORDS.new;
    this.element.hidden = !canDo(project, 'start') && project.state !== 'new';
    setText(this.heading, heading);
    this.lead.hidden = !lead;
    setText(this.lead, lead);
    this.nameField.hidden = project.state !== 'new';
    this.adder.hidden = project.state === 'new' || !canDo(project, 'upload');
    this.go.classList.toggle('primary', project.state !== 'finished');
    if (document.activeElement !== this.name) this.name.value = project.name;
    this.ask(library, project);
    this.showEstimate(project);
    const pending = this.uploads.pending;
    const ready = (canDo(project, 'start') && (project.files?.length > 0 || project.state !== 'new')) || pending > 0;
    this.go.disabled = !ready || this.waiting;
    setText(this.go, this.waiting ? `Starts when all photos are here (${pending} to go)` : verb);
    if (project.state === 'new' && !ready) this.refuse((project.files ?? []).length === 0 ? 'Add photos first.' : project.message || 'More photos are needed.', true);
    else if (this.hint) this.refuse('');
  }

  // Rebuilt only when there are other answers to choose from.
  ask({qualities, devices = [], default_quality: usual}, project) {
    const key = JSON.stringify([qualities, devices]);
    if (key !== this.asked) {
      this.asked = key;
      this.quality = new Choices('Quality', inHalves(qualities), () => {
        this.chosen = true;
        this.showEstimate(this.project);
      }, {stacked: true});
      this.device = devices.length > 1 ? new Choices('Computed on', inHalves(devices), undefined, {stacked: true}) : null;
      if (this.device) this.device.value = devices[0].id;
      fill(this.questions, this.quality.element, this.device?.element);
    }
    if (!this.chosen) this.quality.value = project.quality || usual;
  }

  showEstimate({estimates, state}) {
    const of = (id) => estimates?.[id];
    for (const {id, note} of inHalves(this.session.library.qualities)) {
      this.quality.note(id, [note, of(id)?.seconds > 0 && about(of(id).seconds)].filter(Boolean).join(' · '));
    }
    const chosen = of(this.quality.value);
    const memory = chosen?.memory_bytes > 0 ? ` and ${bytes(chosen.memory_bytes)} of memory` : '';
    const unknown = state === 'new' ? 'How long it takes on this machine is known once it has begun.' : '';
    setText(this.estimate, chosen?.seconds > 0 ? `Takes ${about(chosen.seconds)}${memory} on this machine.` : unknown);
    this.estimate.hidden = !this.estimate.textContent;
  }

  async rename() {
    const name = this.name.value.trim();
    if (name && name !== this.project.name) await attempt(() => post(projectPath(this.project.id, 'rename'), {name}));
    this.session.poll();
  }

  refuse(text, hint = false) {
    this.hint = hint && Boolean(text);
    this.problem.classList.toggle('hint', this.hint);
    this.problem.hidden = !text;
    setText(this.problem, text);
  }

  async start() {
    if (this.uploads.pending > 0) {
      this.waiting = true;
      this.update(this.project);
      return;
    }
    this.waiting = false;
    const device = this.device?.value ?? this.session.library.devices?.[0]?.id ?? 'auto';
    try {
      await post(projectPath(this.project.id, 'start'), {quality: this.quality.value, device});
      this.chosen = false;
      this.refuse('');
    } catch (error) {
      this.refuse(error.message);
    }
    await this.session.poll();
    this.update(this.session.project ?? this.project);
  }
}

const inHalves = (choices) => choices.map(({id, label}) => {
  const [name, note] = halves(label);
  return {id, label: name, note};
});
