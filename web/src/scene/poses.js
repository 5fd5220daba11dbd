// Poses: from the run document (COLMAP: x right, y down, z forward) to three.js (x right, y up, z backward).
import {Matrix4, Quaternion, Vector3} from 'three';

// {position, quaternion, intrinsics} of a view's camera; the quaternion turns three.js camera axes into the world.
export function poseOf(camera) {
  const m = camera.world_to_camera;
  const axes = new Matrix4().set(
    m[0], -m[4], -m[8], 0,
    m[1], -m[5], -m[9], 0,
    m[2], -m[6], -m[10], 0,
    0, 0, 0, 1);
  const position = new Vector3(
    -(m[0] * m[3] + m[4] * m[7] + m[8] * m[11]),
    -(m[1] * m[3] + m[5] * m[7] + m[9] * m[11]),
    -(m[2] * m[3] + m[6] * m[7] + m[10] * m[11]));
  const {width, height, fx, fy, cx, cy} = camera;
  return {position, quaternion: new Quaternion().setFromRotationMatrix(axes), intrinsics: {width, height, fx, fy, cx, cy}};
}

export const forwardOf = (pose) => new Vector3(0, 0, -1).applyQuaternion(pose.quaternion);

// A pose that looks from `position` to `target`.
export function lookingAt(position, target, up, intrinsics) {
  const matrix = new Matrix4().lookAt(position, target, up);
  return {position: position.clone(), quaternion: new Quaternion().setFromRotationMatrix(matrix), intrinsics};
}

export const defaultIntrinsics = {width: 1600, height: 1200, fx: 1400, fy: 1400, cx: 800, cy: 600};

// Up, center and radius of the scene: as the document says, else from the cameras, else from the Gaussians' centers
// (a Float32Array of x, y, z).
export function frameOf(place, poses, centers) {
  const given = (v) => Array.isArray(v) && v.length === 3 && v.every(Number.isFinite);
  const up = given(place?.up) ? new Vector3(...place.up) : meanUp(poses);
  if (given(place?.center) && place.radius > 0) return {up: up.normalize(), center: new Vector3(...place.center), radius: place.radius};
  if (poses.length > 1) return {up, ...seenBy(poses)};
  return {up, ...extentOf(centers)};
}

function meanUp(poses) {
  const sum = new Vector3();
  for (const pose of poses) sum.add(new Vector3(0, 1, 0).applyQuaternion(pose.quaternion));
  return sum.length() > 1e-6 ? sum.normalize() : new Vector3(0, -1, 0);
}

// The point nearest to all optical axes, and the median distance of the cameras to it.
function seenBy(poses) {
  const a = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
  const b = [0, 0, 0];
  for (const pose of poses) {
    const d = forwardOf(pose).toArray();
    const p = pose.position.toArray();
    for (let i = 0; i < 3; i++) {
      for (let j = 0; j < 3; j++) {
        const w = (i === j ? 1 : 0) - d[i] * d[j] + (i === j ? 1e-3 : 0);
        a[i][j] += w;
        b[i] += w * p[j];
      }
    }
  }
  const matrix = new Matrix4().set(...a[0], 0, ...a[1], 0, ...a[2], 0, 0, 0, 0, 1).invert();
  const center = new Vector3(...b).applyMatrix4(matrix);
  const distances = poses.map((pose) => pose.position.distanceTo(center)).sort((x, y) => x - y);
  return {center, radius: Math.max(distances[distances.length >> 1] * 0.6, 1e-6)};
}

// The middle of the Gaussians, and how far the nearer three quarters of them lie from it.
function extentOf(centers) {
  const n = centers ? centers.length / 3 : 0;
  if (n === 0) return {center: new Vector3(), radius: 1};
  const step = Math.max(1, Math.floor(n / 20000));
  const axis = [[], [], []];
  for (let i = 0; i < n; i += step) for (let k = 0; k < 3; k++) axis[k].push(centers[3 * i + k]);
  const middle = axis.map((values) => Float64Array.from(values).sort()[values.length >> 1]);
  const distances = Float64Array.from(axis[0], (_, i) => Math.hypot(...axis.map((values, k) => values[i] - middle[k]))).sort();
  return {center: new Vector3(...middle), radius: Math.max(distances[Math.floor(distances.length * 0.75)], 1e-6)};
}
