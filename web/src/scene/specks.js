// Small Gaussians that float far from all others, as `--remove-outliers` finds them (OutlierGaussians in model_edits.h).
const DEVIATIONS = 3.5;  // robust standard deviations of the logarithm of the distance
const OF_MAD = 1.4826;  // standard deviation of a normal distribution over its median absolute deviation
const LEAST_SPREAD = 0.2;
const REACH = 3;  // standard deviations of a Gaussian within which it is seen
const NEAREST = 1e-12;
const LEAF = 8;
const SLICE_MS = 12;  // then the page has its turn

// Uint8Array, 1 for a speck; undefined when isWanted() turned false meanwhile.
export async function findSpecks(mesh, isWanted) {
  const n = mesh.numSplats;
  const points = new Float32Array(3 * n);
  const reach = new Float64Array(n);
  mesh.forEachSplat((i, center, scales) => {
    points.set([center.x, center.y, center.z], 3 * i);
    reach[i] = Math.log(REACH * Math.max(scales.x, scales.y, scales.z));
  });
  const tree = buildTree(points, n);
  const logs = new Float64Array(n);
  let until = performance.now() + SLICE_MS;
  for (let i = 0; i < n; i++) {
    logs[i] = Math.log(Math.max(Math.sqrt(meanSquareToThree(tree, points, i)), NEAREST));
    if (performance.now() < until) continue;
    await new Promise((done) => setTimeout(done));
    if (!isWanted()) return undefined;
    until = performance.now() + SLICE_MS;
  }
  const middle = median(logs);
  const limit = middle + DEVIATIONS * Math.max(OF_MAD * median(logs.map((l) => Math.abs(l - middle))), LEAST_SPREAD);
  return Uint8Array.from(logs, (l, i) => (n > 1 && l > limit && l > reach[i] ? 1 : 0));
}

const median = (values) => {
  const sorted = Float64Array.from(values).sort();
  return (sorted[(sorted.length - 1) >> 1] + sorted[sorted.length >> 1]) / 2;
};

// A balanced k-d tree: an order of the points in which the middle of each range parts it along axis depth % 3.
function buildTree(points, n) {
  const order = Uint32Array.from({length: n}, (_, i) => i);
  const part = (from, to, axis) => {
    if (to - from <= LEAF) return;
    const middle = (from + to) >> 1;
    select(order, points, {from, to: to - 1, at: middle, axis});
    part(from, middle, (axis + 1) % 3);
    part(middle + 1, to, (axis + 1) % 3);
  };
  part(0, n, 0);
  return order;
}

// Hoare's selection: what belongs at `at` is there, what is less before it, what is more behind it.
function select(order, points, {from, to, at, axis}) {
  const value = (i) => points[3 * order[i] + axis];
  while (from < to) {
    const pivot = value((from + to) >> 1);
    let [i, j] = [from, to];
    while (i <= j) {
      while (value(i) < pivot) i++;
      while (value(j) > pivot) j--;
      if (i > j) break;
      const held = order[i];
      order[i++] = order[j];
      order[j--] = held;
    }
    if (at <= j) to = j;
    else if (at >= i) from = i;
    else return;
  }
}

// Of the distances to the three nearest others.
function meanSquareToThree(order, points, self) {
  const [x, y, z] = [points[3 * self], points[3 * self + 1], points[3 * self + 2]];
  const near = [Infinity, Infinity, Infinity];
  const take = (other) => {
    if (other === self) return;
    const d = (points[3 * other] - x) ** 2 + (points[3 * other + 1] - y) ** 2 + (points[3 * other + 2] - z) ** 2;
    if (d >= near[2]) return;
    if (d < near[1]) {
      near[2] = near[1];
      if (d < near[0]) [near[1], near[0]] = [near[0], d];
      else near[1] = d;
    } else near[2] = d;
  };
  const visit = (from, to, axis) => {
    if (to - from <= LEAF) {
      for (let i = from; i < to; i++) take(order[i]);
      return;
    }
    const middle = (from + to) >> 1;
    const away = points[3 * self + axis] - points[3 * order[middle] + axis];
    const next = (axis + 1) % 3;
    const [first, second] = away < 0 ? [[from, middle], [middle + 1, to]] : [[middle + 1, to], [from, middle]];
    visit(...first, next);
    take(order[middle]);
    if (away * away < near[2]) visit(...second, next);
  };
  visit(0, order.length, 0);
  const found = near.filter(Number.isFinite);
  return found.reduce((a, b) => a + b, 0) / Math.max(found.length, 1);
}
