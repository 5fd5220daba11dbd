// The input cameras as wire pyramids that can be clicked; one color a role.
import {Color, Group, Vector3} from 'three';
import {LineMaterial} from 'three/addons/lines/LineMaterial.js';
import {LineSegments2} from 'three/addons/lines/LineSegments2.js';
import {LineSegmentsGeometry} from 'three/addons/lines/LineSegmentsGeometry.js';
import {ROLES} from '../shared/roles.js';
import {poseOf} from './poses.js';

const EDGES = [0, 1, 0, 2, 0, 3, 0, 4, 1, 2, 2, 3, 3, 4, 4, 1, 5, 6];  // apex, corners from the top left, a mark on top
const NEAR_PIXELS = 14;

export class Frusta {
  constructor(views, frame) {
    this.group = new Group();
    this.items = [];
    const poses = views.map((view) => poseOf(view.camera));
    const size = frustumSize(poses.map((pose) => pose.position), frame);
    views.forEach((view, i) => this.items.push({view, points: pyramid(poses[i], size)}));
    this.visible = Object.fromEntries(Object.keys(ROLES).map((role) => [role, true]));
    this.rebuild();
  }

  // visible: {train, test, proposal}; hidden: the id of a view whose camera is ours; marked: the id of a highlighted one.
  set({visible = this.visible, hidden = this.hidden, marked = this.marked}) {
    const same = hidden === this.hidden && marked === this.marked && Object.keys(visible).every((r) => visible[r] === this.visible[r]);
    Object.assign(this, {visible: {...visible}, hidden, marked});
    if (!same) this.rebuild();
    return !same;
  }

  shown() {
    return this.items.filter(({view}) => this.visible[view.role] && view.id !== this.hidden);
  }

  rebuild() {
    this.clear();
    const shown = this.shown();
    for (const [role, {color}] of Object.entries(ROLES)) {
      this.add(shown.filter(({view}) => view.role === role && view.id !== this.marked), color, 1.6);
    }
    this.add(shown.filter(({view}) => view.id === this.marked), '#ffffff', 3);
  }

  add(items, color, width) {
    if (items.length === 0) return;
    const positions = items.flatMap(({points}) => EDGES.flatMap((i) => points[i].toArray()));
    const geometry = new LineSegmentsGeometry().setPositions(positions);
    const lines = new LineSegments2(geometry, new LineMaterial({color: new Color(color), linewidth: width}));
    lines.frustumCulled = false;
    this.group.add(lines);
  }

  clear() {
    for (const lines of [...this.group.children]) {
      lines.geometry.dispose();
      lines.material.dispose();
      this.group.remove(lines);
    }
  }

  // The view whose frustum is at that point of the canvas (CSS pixels), the nearest one first.
  pick(x, y, camera, size) {
    let best;
    for (const item of this.shown()) {
      const screen = item.points.map((p) => project(p, camera, size));
      if (screen.some((p) => !p)) continue;
      const [apex, a, b, c, d] = screen;
      const middle = {x: (a.x + c.x) / 2, y: (a.y + c.y) / 2};
      const near = Math.hypot(middle.x - x, middle.y - y) < NEAR_PIXELS || Math.hypot(apex.x - x, apex.y - y) < NEAR_PIXELS;
      const faces = [[a, b, c], [a, c, d], [apex, a, b], [apex, b, c], [apex, c, d], [apex, d, a]];
      if (!near && !faces.some((face) => inTriangle(x, y, ...face))) continue;
      if (!best || apex.z < best.depth) best = {view: item.view, depth: apex.z};
    }
    return best?.view;
  }
}

// Where a point is in the canvas, and its depth; nothing when it is behind the camera.
function project(point, camera, size) {
  const p = point.clone().applyMatrix4(camera.matrixWorldInverse);
  if (p.z > -1e-6) return undefined;
  const z = -p.z;
  p.applyMatrix4(camera.projectionMatrix);
  return {x: (p.x * 0.5 + 0.5) * size.width, y: (0.5 - p.y * 0.5) * size.height, z};
}

function inTriangle(x, y, a, b, c) {
  const side = (p, q) => (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
  const s = [side(a, b), side(b, c), side(c, a)];
  return s.every((v) => v >= 0) || s.every((v) => v <= 0);
}

// A third of the usual distance between neighbors, but neither specks nor walls.
function frustumSize(positions, frame) {
  const nearest = positions.map((p, i) => Math.min(...positions.map((q, j) => (i === j ? Infinity : p.distanceTo(q)))));
  const sorted = nearest.filter(Number.isFinite).sort((a, b) => a - b);
  const median = sorted.length ? sorted[sorted.length >> 1] : frame.radius * 0.3;
  return Math.min(Math.max(median * 0.33, 0.02 * frame.radius), 0.12 * frame.radius);
}

function pyramid({position, quaternion, intrinsics: k}, depth) {
  const corner = (x, y) => new Vector3(((x - k.cx) / k.fx) * depth, (-(y - k.cy) / k.fy) * depth, -depth);
  const local = [
    new Vector3(), corner(0, 0), corner(k.width, 0), corner(k.width, k.height), corner(0, k.height),
    corner(k.width * 0.4, -k.height * 0.12), corner(k.width * 0.6, -k.height * 0.12)];
  return local.map((p) => p.applyQuaternion(quaternion).add(position));
}
