// The canvas: a renderer that draws only when something has changed, so that a page at rest costs nothing.
import {Color, PerspectiveCamera, Scene, WebGLRenderer} from 'three';
import {SparkRenderer} from '@sparkjsdev/spark';
import {imageRect, setProjection} from './projection.js';

export const BACKGROUND = 0x0d0f12;
// px^2 of the training images that the rasterizer of OracleGS adds to each footprint, without lowering the opacity.
const LOW_PASS = 0.3;
const SLOW_FRAME_MS = 70;
const REST_MS = 250;

export function hasWebGL2() {
  try {
    return Boolean(document.createElement('canvas').getContext('webgl2'));
  } catch {
    return false;
  }
}

export class Stage {
  // container: an element that gives the size. onDrawn() is called when everything that was asked for is on the canvas.
  constructor(container, onDrawn) {
    this.container = container;
    this.onDrawn = onDrawn;
    this.renderer = new WebGLRenderer({antialias: false, powerPreference: 'high-performance'});
    this.renderer.setClearColor(new Color(BACKGROUND));
    this.canvas = this.renderer.domElement;
    container.append(this.canvas);
    this.scene = new Scene();
    this.camera = new PerspectiveCamera();
    this.camera.matrixAutoUpdate = true;
    this.tickers = new Set();
    this.afterFrame = new Set();
    this.pending = false;
    this.quality = 1;
    this.spark = new SparkRenderer({
      renderer: this.renderer, blurAmount: 0, sortRadial: false, accumExtSplats: true, enableLod: false, maxStdDev: 3,
      onDirty: () => this.invalidate()});
    this.scene.add(this.spark);
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(container);
    this.resize();
  }

  // intrinsics, near, far: see projection.js.
  setLens(intrinsics, near, far) {
    this.lens = {intrinsics, near, far};
    this.project();
    this.invalidate();
  }

  project() {
    if (!this.lens) return;
    setProjection(this.camera, this.lens.intrinsics, this.size, this.lens.near, this.lens.far);
    const perImagePixel = imageRect(this.lens.intrinsics, this.size.width, this.size.height).scale * this.renderer.getPixelRatio();
    this.spark.preBlurAmount = LOW_PASS * perImagePixel ** 2;
  }

  resize() {
    const width = Math.max(1, this.container.clientWidth);
    const height = Math.max(1, this.container.clientHeight);
    this.size = {width, height};
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2) * this.quality);
    this.renderer.setSize(width, height);
    this.project();
    this.invalidate();
  }

  // Draws in the next frame.
  invalidate() {
    clearTimeout(this.restTimer);
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame((now) => this.frame(now));
  }

  // ticker(seconds since the frame before) returns whether it wants another frame.
  addTicker(ticker) {
    this.tickers.add(ticker);
    this.invalidate();
  }

  frame(now) {
    this.pending = false;
    const seconds = this.lastFrame ? Math.min((now - this.lastFrame) / 1000, 0.1) : 1 / 60;
    let moving = false;
    for (const ticker of [...this.tickers]) {
      if (ticker(seconds)) moving = true;
      else this.tickers.delete(ticker);
    }
    this.adapt(moving, now - (this.lastFrame ?? now));
    this.lastFrame = moving ? now : undefined;
    this.camera.updateMatrixWorld();
    this.renderer.render(this.scene, this.camera);
    for (const hook of this.afterFrame) hook();
    if (moving) this.invalidate();
    else this.restTimer = setTimeout(() => this.rest(), REST_MS);
  }

  // Halves the resolution while the camera moves on a machine that is too slow for it.
  adapt(moving, milliseconds) {
    this.slow = moving && milliseconds > SLOW_FRAME_MS ? (this.slow ?? 0) + milliseconds : 0;
    if (this.slow >= 3 * SLOW_FRAME_MS && this.quality === 1) this.setQuality(0.5);
  }

  setQuality(quality) {
    this.quality = quality;
    this.resize();
  }

  rest() {
    if (this.pending || this.spark.sorting || this.spark.dirty) return;
    if (this.quality < 1) this.setQuality(1);
    else this.onDrawn();
  }

  // A PNG of the canvas, whose pixels are there only until the browser has shown them: so it is drawn once more.
  image() {
    if (this.quality < 1) this.setQuality(1);
    this.camera.updateMatrixWorld();
    this.renderer.render(this.scene, this.camera);
    return new Promise((done) => this.canvas.toBlob(done, 'image/png'));
  }

  dispose() {
    this.observer.disconnect();
    clearTimeout(this.restTimer);
    this.spark.dispose();
    this.renderer.dispose();
    this.canvas.remove();
  }
}
