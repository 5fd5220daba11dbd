// The 3D view of a run: the splat, its cameras, and flights between them. Knows no page: it reports by events.
//   "move"     the camera has left the pose of a view
//   "view"     detail = the view that was clicked          "hover"  detail = the view under the pointer, or undefined
//   "arrive"   detail = the view whose pose was reached    "drawn"  everything is on the canvas
//   "lost"     the graphics context was lost               "range"  detail = {near, far}: between which depth has its colors
import {Quaternion, Vector3} from 'three';
import {countClasses} from '../shared/support_classes.js';
import {Controls} from './controls.js';
import {Cut} from './cut.js';
import {depthRange} from './depth_range.js';
import {Frusta} from './frusta.js';
import {defaultIntrinsics, forwardOf, frameOf, lookingAt, poseOf} from './poses.js';
import {imageRect, mixIntrinsics, verticalAngle, widened} from './projection.js';
import {Recoloring} from './recoloring.js';
import {findSpecks} from './specks.js';
import {centersOf, decodeSplat, pointUnder} from './splat.js';
import {Stage} from './stage.js';

const FLIGHT_MS = 700;
const RANGE_CENTERS = 4000;  // of Gaussians that decide the range of depth's colors; looked at whenever the camera moves
const UPS = [[0, -1, 0], [0, 0, 1], [0, 1, 0], [0, 0, -1], [1, 0, 0], [-1, 0, 0]].map((up) => new Vector3(...up));

export class SplatScene extends EventTarget {
  // container: a positioned element; options: see Controls.
  constructor(container, options = {}) {
    super();
    this.stage = new Stage(container, () => this.drawn());
    this.canvas = this.stage.canvas;
    this.views = [];
    this.mode = 'color';
    this.hideBelow = 0;
    this.edits = {};
    this.cut = new Cut({});
    this.settle(lookingAt(new Vector3(0, 0, -3), new Vector3(), new Vector3(0, -1, 0), defaultIntrinsics));
    this.controls = new Controls(this.stage, {
      ...options, pose: () => this.pose, frame: {up: new Vector3(0, -1, 0), center: new Vector3(), radius: 1},
      onMove: () => this.moved(),
      onClick: (x, y) => this.click(x, y),
      onHover: (x, y) => this.hover(x, y),
    });
    this.canvas.addEventListener('dblclick', (event) => this.turnTo(event.offsetX, event.offsetY));
    this.canvas.addEventListener('webglcontextlost', (event) => { event.preventDefault(); this.report('lost'); });
    this.canvas.addEventListener('webglcontextrestored', () => this.stage.invalidate());
  }

  report(name, detail) {
    this.dispatchEvent(new CustomEvent(name, {detail}));
  }

  // The cameras of a document. The pose stays, except the first time, and where only the splat's extent gave it.
  setDocument(run) {
    this.views = (run?.views ?? []).filter((view) => view.camera?.world_to_camera?.length === 16);
    this.place = run?.place ?? run?.splat;  // where up is, and what the cameras look at
    if (this.frusta) {
      this.frusta.clear();
      this.stage.scene.remove(this.frusta.group);
    }
    this.applyFrame();
    this.frusta = new Frusta(this.views, this.controls.frame);
    if (this.visible) this.frusta.set({visible: this.visible});
    this.frusta.set({hidden: this.current?.id});
    this.stage.scene.add(this.frusta.group);
    if (!this.placed || (this.placed === 'by extent' && this.views.length > 0)) this.home(true);
    this.stage.invalidate();
  }

  applyFrame() {
    const poses = this.views.filter((view) => view.role !== 'proposal').map((view) => poseOf(view.camera));
    this.controls.frame = frameOf(this.place, poses, this.centers);
    this.edit(this.edits);
    this.lens();
  }

  // bytes: ArrayBuffer; support, uncertainty: Uint8Array or nothing. Takes the place of the splat before, which is freed.
  async setSplat({bytes, format, support, uncertainty}) {
    const ticket = (this.ticket = (this.ticket ?? 0) + 1);
    const mesh = await decodeSplat(bytes, format);
    if (ticket !== this.ticket) {
      mesh.dispose();
      return;
    }
    const whole = (marks) => (marks && marks.length >= mesh.numSplats ? marks.subarray(0, mesh.numSplats) : undefined);
    this.removeSplat();
    this.marks = {support: whole(support), uncertainty: whole(uncertainty)};
    this.mesh = mesh;
    this.recoloring = new Recoloring(mesh, this.marks);
    this.classCounts = this.marks.support && countClasses(this.marks.support);
    this.someCenters = centersOf(mesh, RANGE_CENTERS);
    if (!this.placed) {
      this.centers = centersOf(mesh);
      this.applyFrame();
      this.home(true);
    }
    this.recolor();
    this.lookForSpecks();
    this.stage.scene.add(mesh);
    this.stage.invalidate();
  }

  removeSplat() {
    if (!this.mesh) return;
    this.stage.scene.remove(this.mesh);
    this.recoloring.dispose();
    this.mesh.dispose();
    this.mesh = this.recoloring = this.marks = this.classCounts = this.someCenters = this.specks = undefined;
  }

  get gaussians() {
    return this.mesh?.numSplats ?? 0;
  }

  // mode: the id of a row in shared/modes.js; hideBelow: support in [0,1].
  show(mode, hideBelow) {
    Object.assign(this, {mode, hideBelow});
    this.recolor();
  }

  recolor() {
    this.recoloring?.set(this.mode, Math.max(this.hideBelow, this.cut.support));
    this.recoloring?.cut(this.cut, this.cut.specks ? this.specks : undefined);
    this.lens();
  }

  // Shows the splat without what these edits leave out, and the edges of a box; see cut.js.
  edit(edits) {
    this.edits = edits;
    if (this.cut.edges) {
      this.stage.scene.remove(this.cut.edges);
      this.cut.edges.dispose();
    }
    this.cut = new Cut(edits, this.controls.frame);
    if (this.cut.edges) this.stage.scene.add(this.cut.edges);
    this.recolor();
    this.lookForSpecks();
  }

  async lookForSpecks() {
    const {mesh} = this;
    if (!mesh || !this.cut.specks || this.specks || this.looking === mesh) return;
    this.looking = mesh;
    const specks = await findSpecks(mesh, () => mesh === this.mesh);
    if (mesh !== this.mesh) return;
    this.specks = specks;
    this.recolor();
  }

  // Whether a Gaussian, whose center is there, is not hidden.
  isShown(index, point) {
    const support = this.marks.support?.[index] ?? 255;
    const isSpeck = this.cut.specks && this.specks?.[index];
    return this.cut.holds(point) && !isSpeck && support / 255 + 0.001 >= Math.max(this.hideBelow, this.cut.support);
  }

  // Degrees from the top of the 3D view to its bottom.
  get fieldOfView() {
    return verticalAngle(this.stage.camera);
  }

  // Until the next flight, which takes the lens of its camera.
  setFieldOfView(degrees) {
    this.pose = {...this.pose, intrinsics: widened(this.pose.intrinsics, this.fieldOfView, degrees)};
    this.moved();
  }

  setVisible(visible) {
    this.visible = {...visible};
    if (this.frusta?.set({visible})) this.stage.invalidate();
  }

  // The first training camera, or a look at the scene as a whole.
  home(atOnce = false) {
    const first = this.views.find((view) => view.role === 'train') ?? this.views.find((view) => view.role === 'test');
    if (first) {
      this.placed = 'at a camera';
      this.fly(poseOf(first.camera), first, {atOnce, quiet: true});
    } else if (this.mesh) {
      this.placed = 'by extent';
      const {up, center, radius} = this.controls.frame;
      const side = Math.abs(up.z) < 0.9 ? new Vector3(0, 0, -1) : new Vector3(0, -1, 0);
      const offset = side.addScaledVector(up, -side.dot(up)).normalize().addScaledVector(up, 0.3).multiplyScalar(2.6 * radius);
      this.fly(lookingAt(center.clone().add(offset), center, up, defaultIntrinsics), undefined, {atOnce});
    }
  }

  // Takes another axis of the world for up; for files, which do not say it.
  nextUp() {
    const frame = this.controls.frame;
    const at = UPS.findIndex((up) => frame.up.distanceTo(up) < 0.01);
    this.place = {center: frame.center.toArray(), radius: frame.radius, up: UPS[(at + 1) % UPS.length].toArray()};
    this.applyFrame();
    this.home();
  }

  // What is on the canvas, as a PNG of its size.
  image() {
    return this.stage.image();
  }

  // Goes to a view's camera; "arrive" follows.
  goTo(view, atOnce = false) {
    this.placed = 'by hand';
    this.fly(poseOf(view.camera), view, {atOnce});
  }

  // What the camera turns around, in the axes of the scene: {point, distance}.
  get focus() {
    const {position} = this.pose;
    return {point: position.clone().addScaledVector(forwardOf(this.pose), this.controls.distance).toArray(), distance: this.controls.distance};
  }

  // Looks at what is under a pixel; the camera turns around that from then on.
  turnTo(x, y) {
    const point = this.mesh && pointUnder(this.mesh, this.stage, x, y, (...which) => this.isShown(...which));
    if (!point) return;
    const {position, quaternion, intrinsics} = this.pose;
    const way = point.clone().sub(position);
    const turn = new Quaternion().setFromUnitVectors(forwardOf(this.pose), way.clone().normalize());
    this.placed = 'by hand';
    this.fly({position: position.clone(), quaternion: turn.multiply(quaternion), intrinsics}, undefined, {distance: way.length()});
  }

  // quiet: no "arrive", for a pose that nobody asked to compare; distance: of the point to turn around, else the scene's.
  fly(to, view, {atOnce = false, quiet = false, distance = undefined}) {
    this.leave();
    const from = {...this.pose, position: this.pose.position.clone(), quaternion: this.pose.quaternion.clone()};
    const near = !distance && from.position.distanceTo(to.position) < 1e-6 * this.controls.frame.radius;
    const still = atOnce || near || matchMedia('(prefers-reduced-motion: reduce)').matches;
    const start = performance.now();
    const flight = (this.flight = {});
    this.stage.addTicker(() => {
      if (flight !== this.flight) return false;
      const t = still ? 1 : Math.min((performance.now() - start) / FLIGHT_MS, 1);
      const eased = t * t * (3 - 2 * t);
      this.settle({
        position: from.position.clone().lerp(to.position, eased), quaternion: from.quaternion.clone().slerp(to.quaternion, eased),
        intrinsics: mixIntrinsics(from.intrinsics, to.intrinsics, eased)});
      if (t < 1) return true;
      this.flight = undefined;
      this.controls.aim();
      if (distance) this.controls.distance = distance;
      if (view) this.arrive(view, quiet);
      return false;
    });
  }

  arrive(view, quiet) {
    this.current = view;
    this.frusta.set({hidden: view.id});
    this.stage.invalidate();
    if (!quiet) this.report('arrive', view);
  }

  leave() {
    if (!this.current) return;
    this.current = undefined;
    this.frusta.set({hidden: undefined});
    this.report('move');
  }

  moved() {
    this.placed = 'by hand';
    this.flight = undefined;
    this.leave();
    this.settle(this.pose);
  }

  settle(pose) {
    this.pose = pose;
    this.stage.camera.position.copy(pose.position);
    this.stage.camera.quaternion.copy(pose.quaternion);
    this.lens();
  }

  lens() {
    const frame = this.controls?.frame;
    if (!frame) return;
    const {radius, center} = frame;
    const far = this.pose.position.distanceTo(center) + 100 * radius;
    this.stage.setLens(this.pose.intrinsics, 0.01 * radius, far);
    if (this.mode === 'depth' && this.mesh) this.measureDepth();
  }

  measureDepth() {
    this.range = depthRange(this.someCenters, this.stage.camera) ?? this.range;
    if (!this.range) return;
    this.recoloring.setRange(this.range);
    this.report('range', this.range);
  }

  // Where the image of the current pose's camera is in the container, in CSS pixels.
  imageRect() {
    return imageRect(this.pose.intrinsics, this.stage.size.width, this.stage.size.height);
  }

  click(x, y) {
    const view = this.frusta?.pick(x, y, this.stage.camera, this.stage.size);
    if (view) this.report('view', view);
  }

  hover(x, y) {
    const view = this.frusta?.pick(x, y, this.stage.camera, this.stage.size);
    if (view === this.hovered) return;
    this.hovered = view;
    this.canvas.style.cursor = view ? 'pointer' : '';
    this.mark(view);
    this.report('hover', view);
  }

  // Highlights the frustum of a view.
  mark(view) {
    if (this.frusta?.set({marked: view?.id})) this.stage.invalidate();
  }

  // Where a view's camera is in the container; for tests and tooltips.
  screenPositionOf(view) {
    const point = poseOf(view.camera);
    const p = point.position.clone().addScaledVector(forwardOf(point), 1e-4).project(this.stage.camera);
    const {width, height} = this.stage.size;
    return {x: (p.x * 0.5 + 0.5) * width, y: (0.5 - p.y * 0.5) * height, visible: Math.abs(p.z) < 1};
  }

  drawn() {
    this.report('drawn');
  }

  dispose() {
    this.removeSplat();
    this.frusta?.clear();
    this.stage.dispose();
  }
}
