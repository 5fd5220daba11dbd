#include "oraclegs/render/cuda/falloff-inl.cuh"
#include "oraclegs/render/cuda/stages.h"

namespace oraclegs::cuda {
namespace {

constexpr int kBatch = kMaxRuns * kRun;  // entries in shared memory at once

/// Blending state of one pixel.
struct Ray {
  float x, y;  // center, px
  float transmittance = 1, r = 0, g = 0, b = 0, inv_z = 0;
  uint32_t end = 0;
  bool open;

  __device__ void Accumulate(const Splat& s, uint32_t entry) {
    const float e = Log2Alpha(s, x - s.mx, y - s.my);
    if (e < kLog2AlphaMin) return;
    const float alpha = Min(Exp2(e), kAlphaMax), next = NextTransmittance(alpha, transmittance);
    if (next < kTransmittanceEnd) {
      open = false;
      return;
    }
    const float weight = alpha * transmittance;
    r = fmaf(weight, s.r, r);
    g = fmaf(weight, s.g, g);
    b = fmaf(weight, s.b, b);
    inv_z = fmaf(weight, s.inv_z, inv_z);
    transmittance = next;
    end = entry + 1;
  }

  __device__ void Save(float* state) const {
    const float values[kStateFloats] = {transmittance, r, g, b, inv_z};
    for (int k = 0; k < kStateFloats; ++k) state[k * kTilePixels + threadIdx.x] = values[k];
  }
};

template <bool kTrain>
__global__ void __launch_bounds__(kTilePixels)
    BlendForwardKernel(BlendInput in, ImagePlanes out, BlendKept kept, Counters* counters) {
  __shared__ Splat batch[kBatch];
  __shared__ uint32_t first_slot;
  if (counters->pairs > static_cast<unsigned long long>(in.listed)) return;
  const uint32_t tile = blockIdx.x;
  const int thread = static_cast<int>(threadIdx.x), lane = LaneInWarp();
  const int tile_x = static_cast<int>(tile % in.camera.tiles_x) * kTile, x = tile_x + PixelX(thread);
  const int tile_y = static_cast<int>(tile / in.camera.tiles_x) * kTile, y = tile_y + PixelY(thread);
  const bool inside = x < in.camera.width && y < in.camera.height;
  const float warp_x = static_cast<float>(tile_x + PixelX(thread - lane)) + 0.5f;
  const float warp_y = static_cast<float>(tile_y + PixelY(thread - lane)) + 0.5f;
  Ray ray;
  ray.x = static_cast<float>(x) + 0.5f, ray.y = static_cast<float>(y) + 0.5f;
  ray.open = inside;
  unsigned long long visited = 0;

  const TileRange range = in.ranges[tile];
  const uint32_t count = range.end - range.begin;
  const uint32_t length = kTrain ? kept.buckets.Length() : kBatch;
  for (uint32_t begin = 0; begin < count; begin += kBatch) {
    if (!__syncthreads_or(ray.open)) break;
    const uint32_t n = count - begin < kBatch ? count - begin : kBatch;
    if (threadIdx.x < n) batch[threadIdx.x] = in.splats[in.entry_ids[range.begin + begin + threadIdx.x]];
    if (kTrain && threadIdx.x == 0) {
      const uint32_t buckets = (n + length - 1) / length;
      first_slot = atomicAdd(&counters->buckets, buckets);
      for (uint32_t k = 0; k < buckets && first_slot + k < kept.buckets.capacity; ++k) {
        kept.buckets.buckets[first_slot + k] = {tile, begin + k * length};
      }
    }
    __syncthreads();
    uint32_t slot = first_slot, bucket = 0;  // the next bucket's
    for (uint32_t run = 0; run < n; run += kRun) {
      if (!__any_sync(kAllLanes, ray.open)) break;
      if (kTrain && run == bucket) {
        if (slot < kept.buckets.capacity) {
          ray.Save(kept.buckets.states + int64_t{slot} * kStateFloats * kTilePixels);
        }
        ++slot, bucket += length;
      }
      // Each lane tests whether one Gaussian reaches the warp's 8 x 4 pixels.
      const uint32_t candidate = run + static_cast<uint32_t>(lane);
      const bool reaches = candidate < n && Reaches(ReachOf(batch[candidate]), warp_x, warp_y, 7.f, 3.f);
      unsigned left = __ballot_sync(kAllLanes, reaches);
      visited += kWarp * __popc(left);
      for (; left != 0; left &= left - 1) {
        const uint32_t i = run + static_cast<uint32_t>(__ffs(static_cast<int>(left)) - 1);
        if (ray.open) ray.Accumulate(batch[i], begin + i);
      }
    }
  }
  if (lane == 0 && visited != 0) atomicAdd(&counters->pixel_pairs, visited);
  if (kTrain) kept.ends[int64_t{tile} * kTilePixels + thread] = ray.end;
  if (!inside || out.image == nullptr) return;
  const int64_t pixel = int64_t{y} * in.camera.width + x;
  out.image[3 * pixel] = fmaf(ray.transmittance, in.camera.background[0], ray.r);
  out.image[3 * pixel + 1] = fmaf(ray.transmittance, in.camera.background[1], ray.g);
  out.image[3 * pixel + 2] = fmaf(ray.transmittance, in.camera.background[2], ray.b);
  out.alpha[pixel] = 1.f - ray.transmittance;
  out.inv_depth[pixel] = ray.inv_z;
}

}  // namespace

void BlendForward(const BlendInput& in, const ImagePlanes& out, const BlendKept& kept, Counters* counters,
                  cudaStream_t stream) {
  const auto kernel = kept.ends != nullptr ? BlendForwardKernel<true> : BlendForwardKernel<false>;
  Launch("blending", kernel, {in.camera.tiles(), kTilePixels}, stream, in, out, kept, counters);
}

}  // namespace oraclegs::cuda
