// Draws a splat as another program does: ?engine=spark|three&file=PATH&width=N&height=N, then draw() for each pose.
import {Color, LinearSRGBColorSpace, Matrix4, PerspectiveCamera, Scene, WebGLRenderer} from 'three';

const params = new URLSearchParams(location.search);
const [engine, file] = [params.get('engine'), params.get('file')];
const [width, height] = [Number(params.get('width')), Number(params.get('height'))];
const LOADERS = {spz: 'SPZLoader', ply: 'GaussianSplatPLYLoader', splat: 'SPLATLoader'};  // of three.js

async function drawnBySpark(scene) {
  const {SparkRenderer, SplatMesh} = await import('spark');
  const renderer = new WebGLRenderer({antialias: false, preserveDrawingBuffer: true});
  const mesh = new SplatMesh({url: file});
  await mesh.initialized;
  scene.add(new SparkRenderer({renderer}), mesh);
  return renderer;
}

async function drawnByThree(scene) {
  const {WebGPURenderer} = await import('three/webgpu');
  const renderer = new WebGPURenderer({antialias: false, forceWebGL: true});
  await renderer.init();
  renderer.outputColorSpace = LinearSRGBColorSpace;  // colors of splats are those of the screen already
  const ending = file.split('.').pop();
  if (ending === 'glb') {
    const [{GLTFLoader}, {GLTFGaussianSplatLoaderExtension}] = await Promise.all([
      import('three/addons/loaders/GLTFLoader.js'), import('three/addons/loaders/GLTFGaussianSplatLoaderExtension.js')]);
    const loader = new GLTFLoader();
    loader.register((parser) => new GLTFGaussianSplatLoaderExtension(parser));
    scene.add((await loader.loadAsync(file)).scene);
  } else {
    const [{GaussianSplat}, loaders] = await Promise.all([
      import('three/addons/objects/GaussianSplat.js'), import(`three/addons/loaders/${LOADERS[ending]}.js`)]);
    scene.add(new GaussianSplat(await new loaders[LOADERS[ending]]().loadAsync(file)));
  }
  return renderer;
}

const scene = new Scene();
scene.background = new Color(0);
const camera = new PerspectiveCamera();
camera.matrixAutoUpdate = false;
const renderer = await (engine === 'three' ? drawnByThree : drawnBySpark)(scene);
renderer.setPixelRatio(1);
renderer.setSize(width, height);
document.body.append(renderer.domElement);

// The picture from a pose, as the address of a PNG. matrix: camera-to-world, rows; fov: vertical, in degrees.
globalThis.draw = async (matrix, fov) => {
  Object.assign(camera, {fov, aspect: width / height, near: 0.01, far: 1000});
  camera.updateProjectionMatrix();
  camera.matrix.copy(new Matrix4().set(...matrix.flat()));
  camera.updateMatrixWorld(true);
  // Both sort beside the drawing: the picture is right once it stays as it is.
  let picture = '';
  for (let same = 0; same < 3;) {
    renderer.render(scene, camera);
    const now = renderer.domElement.toDataURL();
    same = now === picture ? same + 1 : 0;
    picture = now;
    await new Promise((done) => setTimeout(done, 100));
  }
  return picture;
};
globalThis.ready = true;
