// Where another photo would help: a button each, which flies there. The text stands in the 3D view until the camera moves.
import {h, fill} from '../shared/dom.js';

export class Suggestions {
  // container: the element of the scene; onChoose(view) flies there.
  constructor(container, onChoose) {
    this.onChoose = onChoose;
    this.list = h('ol', {class: 'suggestions'});
    this.element = h('section', {class: 'panel', hidden: true, 'aria-label': 'Suggested photos'}, h('h2', {}, 'What to photograph next'), this.list);
    this.caption = h('p', {class: 'suggestion-caption', role: 'status', hidden: true});
    container.append(this.caption);
  }

  setRun(run) {
    const byId = new Map((run?.views ?? []).filter((view) => view.camera).map((view) => [view.id, view]));
    const advice = (run?.registration?.advice ?? []).filter(({view}) => byId.has(view));
    this.element.hidden = advice.length === 0;
    fill(this.list, advice.map(({text, view}, i) => h('li', {},
      h('button', {type: 'button', onclick: () => this.choose(byId.get(view), text)}, `Suggested photo ${i + 1}`), h('p', {class: 'note'}, text))));
  }

  choose(view, text) {
    this.onChoose(view);
    this.awaited = {view, text};
  }

  // Whether the view was flown to as a suggestion: then its text is shown.
  arrived(view) {
    const wanted = this.awaited?.view === view;
    if (wanted) this.caption.textContent = this.awaited.text;
    this.caption.hidden = !wanted;
    this.awaited = undefined;
    return wanted;
  }

  hide() {
    this.caption.hidden = true;
    this.awaited = undefined;
  }
}
