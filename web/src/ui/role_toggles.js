// Which cameras are drawn: a switch for each role that has views.
import {ROLES} from '../shared/roles.js';
import {h, fill} from '../shared/dom.js';

export class RoleToggles {
  // onChange({train, test, proposal}: booleans). On a phone the cameras would cover the scene, and are off at first.
  constructor(onChange) {
    this.onChange = onChange;
    const on = !matchMedia('(max-width: 760px)').matches;
    this.visible = Object.fromEntries(Object.keys(ROLES).map((role) => [role, on]));
    this.element = h('div', {class: 'roles', role: 'group', 'aria-label': 'Cameras in the 3D view'});
  }

  setViews(views) {
    fill(this.element, Object.entries(ROLES).map(([role, {plural, color}]) => {
      const count = views.filter((view) => view.role === role).length;
      if (count === 0) return null;
      const dot = h('span', {class: 'dot', 'aria-hidden': 'true'});
      dot.style.background = color;
      const box = h('input', {type: 'checkbox', checked: this.visible[role], onchange: () => {
        this.visible[role] = box.checked;
        this.onChange(this.visible);
      }});
      return h('label', {class: 'role'}, box, dot, `${plural} (${count})`);
    }));
    this.element.hidden = this.element.childElementCount === 0;
  }

  // All off, or all on when none is.
  toggleAll() {
    const boxes = [...this.element.querySelectorAll('input')];
    const on = boxes.every((box) => !box.checked);
    for (const box of boxes) if (box.checked !== on) box.click();
  }
}
