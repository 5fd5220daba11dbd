// A run document about the small scene, and every file that it names. The same pages show real runs.
import {encodePng} from './png.mjs';
import {ballCenter, makeCamera, makeGaussians, render} from './scene.mjs';
import {encodeSplat, encodeSpz} from './splat_files.mjs';

const CAMERAS = [
  ['train', 0, 1.5, 0], ['train', 0.5, 1.2, 0.06], ['train', -0.5, 1.4, 0], ['train', 1.1, 1.6, 0], ['train', -1.1, 1.3, 0],
  ['test', 0.25, 1.4, 0], ['test', -0.8, 1.5, 0], ['proposal', 1.7, 1.5, 0], ['proposal', -1.8, 1.3, 0]];

const NAMES = {train: 'train', test: 'test', proposal: 'coverage'};

// {document, files: Map of path to bytes, gaussians}
export function makeRun() {
  const gaussians = makeGaussians();
  const files = new Map();
  const put = (path, bytes) => (files.set(path, bytes), {url: path});
  const views = CAMERAS.map(([role, angle, height, roll], id) => {
    const camera = makeCamera(angle, height, roll);
    const image = render(gaussians, camera);
    const at = (name) => `report/images/${id}_${name}.png`;
    const view = {id, name: `${NAMES[role]}_${String(id).padStart(4, '0')}`, role, camera, image: put(at('image'), encodePng(image))};
    if (role === 'train') return view;
    view.render = view.image;  // the truth is the reference; the photo differs from it a little
    view.image = put(at('photo'), encodePng(changed(image, (v) => v * 0.9)));
    if (role === 'test') {
      const error = encodePng(changed(image, (v, i) => (i % 3 === 0 ? 255 - v : 20)));
      return {...view, error: put(at('error'), error), support: put(at('support'), encodePng(changed(image, (_, i) => [0, 114, 178][i % 3]))),
              uncertainty: put(at('uncertainty'), encodePng(changed(image, (_, i) => [126, 3, 168][i % 3]))),
              psnr: 27.1 + id / 10, ssim: 0.87, lpips: 0.12};
    }
    const confidence = encodePng(changed(image, (_, i) => [240, 249, 33][i % 3]));
    return {...view, confidence: put(at('confidence'), confidence), nearest: 3, mean_confidence: 0.78, source: 'splat'};
  });
  const spz = encodeSpz(gaussians);
  const document = {
    format: 1, kind: 'run', title: 'four balls', program: 'oraclegs 0.1.0', created: '2026-01-01T10:00:00Z', finished: true,
    hero: {url: 'report/images/5_image.png', caption: 'test_0005, which nothing was trained on'},
    splat: {...put('report/splat.spz', spz), format: 'spz', gaussians: gaussians.length, bytes: spz.length, sh_degree: 0,
            support: put('report/support.bin', Buffer.from(gaussians.map((g) => Math.round(255 * g.support)))),
            uncertainty: put('report/uncertainty.bin', Buffer.from(gaussians.map((g) => Math.round(255 * (1 - g.support)))))},
    place: {up: [0, -1, 0], center: [0, -0.3, 0], radius: 1.6},
    views, points: {...put('report/points.bin', pointBytes(gaussians)), count: gaussians.length},
    scores: {psnr: 27.65, ssim: 0.87, lpips: 0.12, psnr_color_corrected: 28.01}, ...tables(),
  };
  return {document, files, gaussians};
}

// The state of a run that trains: iteration of 1000, with a snapshot of the splat.
export function makeLive(iteration, state = 'running') {
  const x = Array.from({length: 20}, (_, i) => Math.round(((i + 1) * iteration) / 20));
  return {
    format: 1, state, message: state === 'failed' ? 'The disk is full.' : '', started: '2026-01-01T10:00:00Z', elapsed_seconds: iteration / 10,
    updated: '2026-01-01T10:01:00Z',
    stages: [{name: 'depth', state: 'done', seconds: 12.5},
             {name: 'train', state: state === 'running' ? 'running' : 'done', seconds: iteration / 10, done: iteration, total: 1000, unit: 'iterations',
              detail: 'loss 0.05', eta_seconds: (1000 - iteration) / 10}],
    curves: [{name: 'loss', unit: '', x_name: 'iteration', x, y: x.map((v) => 0.3 * Math.exp(-v / 400) + 0.02)}],
    splat: {url: 'live/splat.splat', iteration, gaussians: 2700}, warnings: [], document: true, document_revision: 1,
  };
}

// A snapshot: the scene with the colors of its balls rotated, so that it differs from the others.
export const makeSnapshot = (gaussians, turn) =>
  encodeSplat(gaussians.map((g) => ({...g, color: g.color.map((_, k) => g.color[(k + turn) % 3])})));

function changed({width, height, rgb}, change) {
  return {width, height, rgb: Uint8Array.from(rgb, (v, i) => Math.max(0, Math.min(255, change(v, i))))};
}

function pointBytes(gaussians) {
  const out = Buffer.alloc(15 * gaussians.length);
  gaussians.forEach(({position, color}, i) => {
    position.forEach((v, k) => out.writeFloatLE(v, 15 * i + 4 * k));
    out.set(color.map((c) => Math.round(255 * c)), 15 * i + 12);
  });
  return out;
}

function tables() {
  const x = Array.from({length: 60}, (_, i) => (i + 1) * 100);
  const bins = Array.from({length: 10}, (_, i) => ({confidence: 0.05 + i / 10, similarity: 0.3 + i * 0.06, share: 0.08 + i * 0.09}));
  const classes = ['seen by two or more images', 'seen by one image', 'proposed and trusted', 'weakly supported'];
  return {
    stages: [{name: 'sfm', seconds: 3.1}, {name: 'depth', seconds: 21.4}, {name: 'train', seconds: 301.2}, {name: 'evaluate', seconds: 2.2}],
    curves: [{name: 'loss', unit: '', x_name: 'iteration', x, y: x.map((v) => 0.3 * Math.exp(-v / 900) + 0.02)},
             {name: 'Gaussians', unit: '', x_name: 'iteration', x, y: x.map((v) => 1500 + v / 2)}],
    uncertainty: {models: {auroc_large_error: 0.88, ause_ratio: 0.31},
                  bound: {photos: 6, share: 0.9, classes: [{from: 0, to: 0.03, below: 0.061, pixels: 0.8, covered: 0.93}, {from: 0.03, to: 0.1, below: 0.17, pixels: 0.2, covered: 0.91}, {from: 0.1, to: 1, below: null, pixels: 0, covered: null}]}},
    support: {classes: classes.map((name, i) => ({name, share: [0.8, 0.1, 0.07, 0.03][i], gaussians: [0.7, 0.15, 0.1, 0.05][i], mean_error: 0.03 * (i + 1)}))},
    calibration: {title: 'Trust and truth', x_name: 'trust', y_name: 'share of right pixels', bins},
    registration: {registered: 5, photos: 6, reprojection_error: 0.52, parallax_degrees: 20.4, warnings: [],
                   views: [{name: 'train_0000', status: 'registered', why: '', advice: '', registered: true},
                           {name: 'blurred', status: 'not registered', why: 'few features', advice: 'Take it again with a steady hand.', registered: false}],
                   advice: [{text: 'Take a photo near train_0003.', view: 7}, {text: 'Take a photo between train_0003 and train_0004.', view: 8}]},
    options: [{name: 'iterations', value: '6000', changed: true}, {name: 'seed', value: '0', changed: false}, {name: 'sh_degree', value: '3', changed: false}],
    command: 'oraclegs reconstruct "four balls/" -o out --iterations 6000', licenses: [{name: 'OracleGS', license: 'Apache-2.0', note: ''}],
    warnings: ['<b>One photo</b> was not registered.'], non_commercial: [], memory_bytes: 812345678, device: 'cpu',
  };
}

export {ballCenter};
