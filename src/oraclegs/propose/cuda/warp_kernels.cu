#include "oraclegs/propose/cuda/warp_kernels.h"

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/propose/warp_shading.h"

namespace oraclegs::cuda {
namespace {

constexpr int kBlock = 128;

__device__ int64_t ThreadOfGrid() { return static_cast<int64_t>(blockIdx.x) * kBlock + threadIdx.x; }

/// Counts samples, or lists them: one kernel for the two, so that they find the same pixels to the last bit.
__global__ void SplatDepths(WarpScene scene, int k, PixelBand band, uint32_t* cursors, WarpSample* samples) {
  const WarpSource& from = scene.sources[k];
  const int64_t i = ThreadOfGrid();
  if (i >= static_cast<int64_t>(from.width) * from.height) return;
  const DepthSplat splat = SplatOf(scene, from, static_cast<int>(i % from.width), static_cast<int>(i / from.width));
  if (splat.right < splat.left) return;
  const WarpSample sample = SampleOf(splat.inv_depth, k, from.confidence[i]);
  for (int y = splat.top; y <= splat.bottom; ++y) {
    for (int x = splat.left; x <= splat.right; ++x) {
      const int64_t pixel = static_cast<int64_t>(y) * scene.width + x;
      if (pixel < band.begin || pixel >= band.end) continue;
      const uint32_t place = atomicAdd(cursors + pixel, 1u) - band.first;
      if (samples != nullptr && place < band.samples) samples[place] = sample;
    }
  }
}

/// Order of samples: near to far, then by source, then by weight, so that the order is unique.
__device__ bool Before(const WarpSample& a, const WarpSample& b) {
  if (a.inv_depth != b.inv_depth) return a.inv_depth > b.inv_depth;
  return a.source != b.source ? a.source < b.source : a.weight > b.weight;
}

/// Heap sort: in place, and never slow, even when many samples fall on a pixel that shows a far-off view small.
__device__ void SortSamples(WarpSample* samples, int64_t count) {
  int64_t root = count / 2, end = count;
  while (end > 1) {
    WarpSample moved;
    if (root > 0) {
      moved = samples[--root];
    } else {
      moved = samples[--end];
      samples[end] = samples[0];
    }
    int64_t place = root;
    for (int64_t child = 2 * place + 1; child < end; child = 2 * place + 1) {
      if (child + 1 < end && Before(samples[child], samples[child + 1])) ++child;
      if (!Before(moved, samples[child])) break;
      samples[place] = samples[child];
      place = child;
    }
    samples[place] = moved;
  }
}

/// Votes found by searching a surface's samples, which are few; needs no memory per source.
struct SearchedVotes {
  const WarpSample *begin = nullptr, *end = nullptr;

  __device__ void Count(const WarpSample* first, const WarpSample* last) { begin = first, end = last; }
  __device__ float Of(int source) const {
    int most = 0;
    for (const WarpSample* s = begin; s < end; ++s) {
      if (s->source == source && s->weight > most) most = s->weight;
    }
    return static_cast<float>(most) / kFullWeight;
  }
};

__global__ void FindSurfaces(SurfacesInput in) {
  const int64_t i = in.band.begin + ThreadOfGrid();
  if (i >= in.band.end) return;
  const uint32_t count = in.counts[i];
  WarpSample* samples = in.samples + (in.ends[i] - count - in.band.first);
  SortSamples(samples, count);
  const auto pixel = static_cast<size_t>(i);
  const float inv_depth = SurfaceAmong(in.scene, pixel, samples, count, SearchedVotes());
  in.inv_depth[i] = inv_depth;
  in.beside[i] = !(inv_depth > 0) && in.scene.bounded && MissesObject(in.scene, pixel);
}

__global__ void Shade(ShadeInput in) {
  const int64_t i = ThreadOfGrid();
  const auto pixel = static_cast<size_t>(i);
  if (pixel >= in.scene.pixels()) return;
  const ShadedPixel shaded = ShadePixel(in.scene, pixel, in.inv_depth[i], in.beside[i] != 0);
  in.rgb[3 * i] = shaded.color.x, in.rgb[3 * i + 1] = shaded.color.y, in.rgb[3 * i + 2] = shaded.color.z;
  in.known[i] = shaded.known;
  in.evidence[i] = shaded.evidence;
  in.provenance[i] = shaded.provenance;
}

LaunchShape ShapeFor(int64_t items) { return LaunchShape::For(items, kBlock); }
LaunchShape ShapeFor(const WarpSource& source) { return ShapeFor(static_cast<int64_t>(source.width) * source.height); }

}  // namespace

void RunCountSamples(const WarpScene& scene, const WarpSource& source, int k, uint32_t* counts, cudaStream_t stream) {
  const PixelBand all{0, static_cast<int64_t>(scene.pixels()), 0, 0};
  Launch("counting warped depths", SplatDepths, ShapeFor(source), stream, scene, k, all, counts, nullptr);
}

void RunListSamples(const WarpScene& scene, const WarpSource& source, int k, const SampleLists& lists,
                    cudaStream_t stream) {
  Launch("listing warped depths", SplatDepths, ShapeFor(source), stream, scene, k, lists.band, lists.ends,
         lists.samples);
}

void RunFindSurfaces(const SurfacesInput& in, cudaStream_t stream) {
  Launch("voting for surfaces", FindSurfaces, ShapeFor(in.band.end - in.band.begin), stream, in);
}

void RunShade(const ShadeInput& in, cudaStream_t stream) {
  Launch("coloring a warp", Shade, ShapeFor(static_cast<int64_t>(in.scene.pixels())), stream, in);
}

}  // namespace oraclegs::cuda
