// A splat file as a mesh: decoded in Spark's worker, with full-precision centers, because scenes have any scale.
import {Vector3} from 'three';
import {SplatFileType, SplatMesh} from '@sparkjsdev/spark';

const TYPES = {ply: SplatFileType.PLY, spz: SplatFileType.SPZ, splat: SplatFileType.SPLAT, sog: SplatFileType.PCSOGSZIP};

// bytes: an ArrayBuffer; format: "spz", "splat", "ply", "sog". Throws when the bytes are no such file.
export async function decodeSplat(bytes, format) {
  const mesh = new SplatMesh({
    fileBytes: new Uint8Array(bytes), fileType: TYPES[format], extSplats: true, raycastable: false, editable: false});
  await mesh.initialized;
  if (format === 'spz') mesh.quaternion.set(1, 0, 0, 0);  // its y is up and its z backward: half a turn about x
  return mesh;
}

const NEAR_PIXELS = 10;
const SOLID = 0.3;  // opacity from which a Gaussian is part of a surface
const FRONT = 0.2;  // of the Gaussians under a pixel lie before the surface that is seen there

// The point of the splat under a pixel of a stage's canvas (CSS pixels); nothing where nothing solid is. isShown(index, point):
// whether a Gaussian is not hidden.
export function pointUnder(mesh, {camera, size}, x, y, isShown) {
  const found = [];
  const seen = new Vector3();
  mesh.forEachSplat((index, center, scales, quaternion, opacity) => {
    if (opacity < SOLID) return;
    const point = center.clone().applyQuaternion(mesh.quaternion);
    seen.copy(point).project(camera);
    const away = Math.hypot((seen.x * 0.5 + 0.5) * size.width - x, (0.5 - seen.y * 0.5) * size.height - y);
    if (Math.abs(seen.z) < 1 && away < NEAR_PIXELS && isShown(index, point)) found.push({point, depth: seen.z});
  });
  found.sort((a, b) => a.depth - b.depth);
  return found[Math.floor(found.length * FRONT)]?.point;
}

// The centers of at most `limit` Gaussians, evenly chosen: Float32Array of x, y, z.
export function centersOf(mesh, limit = 20000) {
  const step = Math.max(1, Math.floor(mesh.numSplats / limit));
  const out = [];
  mesh.forEachSplat((index, center) => {
    if (index % step !== 0) return;
    const world = center.clone().applyQuaternion(mesh.quaternion);
    out.push(world.x, world.y, world.z);
  });
  return Float32Array.from(out);
}
