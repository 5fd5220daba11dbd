// Moves the camera with mouse, touch and keys. The whole pose turns about a pivot, so the roll of a photo stays.
import {Quaternion, Vector3} from 'three';

const MAX_ELEVATION = 1.5;  // rad from the horizon
const KEY_TURN = 1.2;  // rad/s
const KEY_MOVE = 0.7;  // pivot distances/s
const MOVES = {
  ArrowLeft: [-1, 0, 0, 0, 0], ArrowRight: [1, 0, 0, 0, 0], ArrowUp: [0, -1, 0, 0, 0], ArrowDown: [0, 1, 0, 0, 0],
  w: [0, 0, 0, 0, -1], s: [0, 0, 0, 0, 1], a: [0, 0, -1, 0, 0], d: [0, 0, 1, 0, 0], q: [0, 0, 0, -1, 0], e: [0, 0, 0, 1, 0],
  '+': [0, 0, 0, 0, -1], '=': [0, 0, 0, 0, -1], '-': [0, 0, 0, 0, 1],
};  // turn right, turn down, move right, move up, move back

export class Controls {
  // pose(): {position, quaternion} to change in place; frame: {up, center, radius}; onMove() after each change;
  // onClick(x, y) for a press without a drag, onHover(x, y). wheelNeedsFocus: the page scrolls until the canvas is clicked.
  constructor(stage, options) {
    Object.assign(this, {stage, distance: 1, ...options});
    this.pointers = new Map();
    this.keys = new Set();
    const canvas = stage.canvas;
    canvas.tabIndex = 0;
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, (event) => this.up(event));
    canvas.addEventListener('wheel', (event) => this.wheel(event), {passive: false});
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('keydown', (event) => this.key(event, true));
    canvas.addEventListener('keyup', (event) => this.key(event, false));
    canvas.addEventListener('blur', () => this.keys.clear());
  }

  // The pivot lies this far in front of the camera: at the depth of the scene's center.
  aim() {
    const {position, quaternion} = this.pose();
    const forward = new Vector3(0, 0, -1).applyQuaternion(quaternion);
    const depth = this.frame.center.clone().sub(position).dot(forward);
    this.distance = Math.max(depth, 0.2 * this.frame.radius);
  }

  // Angles in rad: the camera goes to the right and upwards around the pivot.
  orbit(right, upwards) {
    const pose = this.pose();
    const up = this.frame.up;
    const forward = new Vector3(0, 0, -1).applyQuaternion(pose.quaternion);
    const pivot = pose.position.clone().addScaledVector(forward, this.distance);
    const elevation = Math.asin(Math.max(-1, Math.min(1, -forward.dot(up))));
    const change = upwards > 0 ? Math.min(upwards, Math.max(0, MAX_ELEVATION - elevation))
                               : Math.max(upwards, Math.min(0, -MAX_ELEVATION - elevation));
    const side = new Vector3().crossVectors(forward, up).normalize();
    if (side.lengthSq() < 0.5) side.set(1, 0, 0).applyQuaternion(pose.quaternion);
    const turn = new Quaternion().setFromAxisAngle(up, right).multiply(new Quaternion().setFromAxisAngle(side, -change));
    pose.position.sub(pivot).applyQuaternion(turn).add(pivot);
    pose.quaternion.premultiply(turn).normalize();
    this.onMove();
  }

  // Scene units along the camera's right and up.
  pan(right, upwards) {
    const {position, quaternion} = this.pose();
    position.addScaledVector(new Vector3(1, 0, 0).applyQuaternion(quaternion), right);
    position.addScaledVector(new Vector3(0, 1, 0).applyQuaternion(quaternion), upwards);
    this.onMove();
  }

  // factor < 1: nearer to the pivot. Close to it, the pivot moves along, so that one can walk through a scene.
  zoom(factor) {
    const {position, quaternion} = this.pose();
    const forward = new Vector3(0, 0, -1).applyQuaternion(quaternion);
    const least = 0.05 * this.frame.radius;
    const wanted = this.distance * factor;
    position.addScaledVector(forward, factor < 1 ? Math.max(this.distance - wanted, 0.02 * least) : this.distance - wanted);
    this.distance = Math.min(Math.max(wanted, least), 50 * this.frame.radius);
    this.onMove();
  }

  down(event) {
    this.stage.canvas.focus({preventScroll: true});
    this.stage.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
    this.press = this.pointers.size === 1 ? {x: event.clientX, y: event.clientY, travel: 0} : undefined;
    this.panning = event.button !== 0 || event.shiftKey;
  }

  move(event) {
    const last = this.pointers.get(event.pointerId);
    if (!last) {
      this.onHover(event.offsetX, event.offsetY);
      return;
    }
    const dx = event.clientX - last.x;
    const dy = event.clientY - last.y;
    if (this.press) this.press.travel += Math.abs(dx) + Math.abs(dy);
    if (this.press && this.press.travel < 4) return;
    const before = this.spread();
    this.pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
    if (this.pointers.size >= 2) {
      const after = this.spread();
      if (before > 0 && after > 0) this.zoom(before / after);
      this.drag(dx / 2, dy / 2);
    } else if (this.panning) {
      this.drag(dx, dy);
    } else {
      const perPixel = Math.PI / Math.max(300, this.stage.size.height);
      this.orbit(-dx * perPixel, dy * perPixel);
    }
  }

  // Pixels: what is at the pivot's depth follows the pointer.
  drag(dx, dy) {
    const pixel = (2 * this.distance) / (this.stage.camera.projectionMatrix.elements[5] * this.stage.size.height);
    this.pan(-dx * pixel, dy * pixel);
  }

  spread() {
    const [a, b] = [...this.pointers.values()];
    return b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  }

  up(event) {
    this.pointers.delete(event.pointerId);
    if (event.type === 'pointerup' && this.press && this.press.travel < 4) this.onClick(event.offsetX, event.offsetY);
    this.press = undefined;
  }

  wheel(event) {
    if (this.wheelNeedsFocus && document.activeElement !== this.stage.canvas) return;
    event.preventDefault();
    const pixels = event.deltaY * (event.deltaMode === 1 ? 16 : 1);
    this.zoom(Math.exp(Math.max(-120, Math.min(120, pixels)) * 0.0015));
  }

  key(event, pressed) {
    const name = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (!MOVES[name] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    if (!pressed) {
      this.keys.delete(name);
    } else if (!this.keys.has(name)) {
      this.keys.add(name);
      this.fast = event.shiftKey;
      this.holdKeys(1 / 30);  // a short press counts, however slow the frames are
      this.stage.addTicker((seconds) => this.holdKeys(seconds));
    }
  }

  holdKeys(seconds) {
    if (this.keys.size === 0) return false;
    const sum = [0, 0, 0, 0, 0];
    for (const name of this.keys) MOVES[name].forEach((value, i) => { sum[i] += value; });
    const speed = seconds * (this.fast ? 3 : 1);
    if (sum[0] || sum[1]) this.orbit(sum[0] * KEY_TURN * speed, -sum[1] * KEY_TURN * speed);
    if (sum[2] || sum[3]) this.pan(sum[2] * KEY_MOVE * speed * this.distance, sum[3] * KEY_MOVE * speed * this.distance);
    if (sum[4]) this.zoom(Math.exp(sum[4] * KEY_MOVE * speed));
    return true;
  }
}
