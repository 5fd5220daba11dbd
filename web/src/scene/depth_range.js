// The distances between which most of what is in sight lies.
import {Matrix4, Vector3} from 'three';

const CUT = 0.02;  // of the Gaussians at each end, so that floaters do not use up the colors

// centers: Float32Array of x, y, z. {near, far} in scene units; nothing where nothing is in sight.
export function depthRange(centers, camera) {
  camera.updateMatrixWorld();
  const toScreen = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
  const point = new Vector3();
  const distances = [];
  for (let i = 0; i < centers.length; i += 3) {
    point.fromArray(centers, i);
    const distance = point.distanceTo(camera.position);
    point.applyMatrix4(toScreen);
    if (Math.abs(point.x) < 1 && Math.abs(point.y) < 1 && Math.abs(point.z) < 1) distances.push(distance);
  }
  if (distances.length === 0) return undefined;
  const sorted = Float64Array.from(distances).sort();
  const at = (share) => sorted[Math.round(share * (sorted.length - 1))];
  return {near: at(CUT), far: Math.max(at(1 - CUT), 1.001 * at(CUT))};
}
