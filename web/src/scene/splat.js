// A splat file as a mesh: decoded in Spark's worker, with full-precision centers, because scenes have any scale.
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
