// How intrinsics fill a canvas of another shape: the whole image is visible and centerd, and the 3D view goes on around it.
import {Matrix4} from 'three';

// The rectangle of the image in the canvas, and canvas pixels per image pixel.
export function imageRect(intrinsics, width, height) {
  const scale = Math.min(width / intrinsics.width, height / intrinsics.height);
  const w = intrinsics.width * scale;
  const h = intrinsics.height * scale;
  return {left: (width - w) / 2, top: (height - h) / 2, width: w, height: h, scale};
}

// Writes the projection of a canvas of that size; near and far in scene units.
export function setProjection(camera, intrinsics, size, near, far) {
  const rect = imageRect(intrinsics, size.width, size.height);
  const x = (2 * intrinsics.fx * rect.scale) / size.width;
  const y = (2 * intrinsics.fy * rect.scale) / size.height;
  const ox = 1 - (2 * (rect.left + intrinsics.cx * rect.scale)) / size.width;
  const oy = (2 * (rect.top + intrinsics.cy * rect.scale)) / size.height - 1;
  camera.projectionMatrix = new Matrix4().set(
    x, 0, ox, 0,
    0, y, oy, 0,
    0, 0, -(far + near) / (far - near), (-2 * far * near) / (far - near),
    0, 0, -1, 0);
  camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
  camera.near = near;
  camera.far = far;
}

// Between two intrinsics, as if both images had the size of the second.
export function mixIntrinsics(from, to, t) {
  const sx = to.width / from.width;
  const sy = to.height / from.height;
  const mix = (a, b) => a + (b - a) * t;
  return {
    width: to.width, height: to.height,
    fx: mix(from.fx * sx, to.fx), fy: mix(from.fy * sy, to.fy),
    cx: mix(from.cx * sx, to.cx), cy: mix(from.cy * sy, to.cy),
  };
}

const radians = (degrees) => (degrees * Math.PI) / 180;

// Degrees between the upper and the lower edge of what a camera shows.
export const verticalAngle = (camera) => (2 * Math.atan(1 / camera.projectionMatrix.elements[5]) * 180) / Math.PI;

// Intrinsics of a lens that shows `to` degrees where these show `from`.
export function widened(intrinsics, from, to) {
  const scale = Math.tan(radians(from) / 2) / Math.tan(radians(to) / 2);
  return {...intrinsics, fx: intrinsics.fx * scale, fy: intrinsics.fy * scale};
}
