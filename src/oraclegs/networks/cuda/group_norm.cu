// Three kernels: sums of each group over blocks of pixels; the factors of each channel; their application. A thread
// keeps to one pair of channels and goes from pixel to pixel.

#include "oraclegs/networks/cuda/kernels.h"

#include "oraclegs/core/cuda/fast_math-inl.cuh"
#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/networks/cuda/bfloat16-inl.cuh"

namespace oraclegs::cuda {
namespace {

constexpr int kThreads =
    320;  // multiples of 160 pairs of channels fill such blocks; of the networks' widths all but 480 are
constexpr int kFactorThreads = 256;
constexpr int kMaxPairs = kGroupNormChannels / 2;
constexpr int kAtOnce = 4;  // pixels that a thread reads before it computes

/// The part of an image that a block works on.
struct Chunk {
  int64_t image;
  int first, pixels;
};
__device__ Chunk ChunkOf(const GroupNorm& in) {
  const int chunks = GroupNormChunks(in);
  const int first = static_cast<int>(blockIdx.x) % chunks * kGroupNormPixelsABlock, left = in.pixels - first;
  return {blockIdx.x / chunks, first, left < kGroupNormPixelsABlock ? left : kGroupNormPixelsABlock};
}

/// Narrow maps give a block several pixels at a time.
__device__ int RowsOf(int pairs) { return pairs < kThreads ? kThreads / pairs : 1; }

__global__ void GroupNormSumsKernel(GroupNorm in, GroupNormPair* sums) {
  __shared__ float2 parts[kMaxPairs];
  const int pairs = in.channels / 2, rows = RowsOf(pairs);
  const Chunk chunk = ChunkOf(in);
  const unsigned* x = Pairs(in.x) + (chunk.image * in.pixels + chunk.first) * pairs;
  for (int item = static_cast<int>(threadIdx.x); item < pairs * rows; item += kThreads) {
    const int pair = item % pairs;
    const float2 offset = in.offsets == nullptr ? float2{0, 0} : Unpack(Pairs(in.offsets)[chunk.image * pairs + pair]);
    float sum = 0, squares = 0;
#pragma unroll 8
    for (int p = item / pairs; p < chunk.pixels; p += rows) {
      const float2 v = Unpack(x[static_cast<int64_t>(p) * pairs + pair]);
      const float a = v.x + offset.x, b = v.y + offset.y;
      sum += a + b;
      squares = fmaf(a, a, fmaf(b, b, squares));
    }
    parts[item] = {sum, squares};
  }
  __syncthreads();
  const int group = static_cast<int>(threadIdx.x), width = pairs / in.groups;
  if (group >= in.groups) return;
  float sum = 0, squares = 0;
  for (int row = 0; row < rows; ++row) {
    for (int k = 0; k < width; ++k) {
      const float2 part = parts[row * pairs + group * width + k];
      sum += part.x, squares += part.y;
    }
  }
  sums[static_cast<int64_t>(blockIdx.x) * in.groups + group] = {sum, squares};
}

/// One block an image: y = x a + b for each channel.
__global__ void GroupNormFactorsKernel(GroupNorm in, const GroupNormPair* sums, GroupNormPair* factors) {
  __shared__ float2 of_groups[kGroupNormGroups];  // mean, 1 / deviation
  const int64_t image = blockIdx.x;
  const int thread = static_cast<int>(threadIdx.x), lane = thread % kWarp;
  const int chunks = GroupNormChunks(in);
  const int width = in.channels / in.groups;
  const double count = static_cast<double>(in.pixels) * width;
  for (int group = thread / kWarp; group < in.groups; group += kFactorThreads / kWarp) {
    double sum = 0, squares = 0;
    for (int c = lane; c < chunks; c += kWarp) {
      const GroupNormPair part = sums[(image * chunks + c) * in.groups + group];
      sum += static_cast<double>(part.a), squares += static_cast<double>(part.b);
    }
    const double mean = WarpSum(sum) / count, square = WarpSum(squares) / count, variance = square - mean * mean;
    const float deviation = sqrtf(static_cast<float>(variance < 0 ? 0 : variance) + in.eps);
    if (lane == 0) of_groups[group] = {static_cast<float>(mean), 1.f / deviation};
  }
  __syncthreads();
  for (int c = thread; c < in.channels; c += kFactorThreads) {
    const float2 group = of_groups[c / width];
    const float offset = in.offsets == nullptr ? 0.f : FromBfloat16(in.offsets[image * in.channels + c]);
    const float scale = group.y * FromBfloat16(in.weight[c]);
    factors[image * in.channels + c] = {scale, fmaf(offset - group.x, scale, FromBfloat16(in.bias[c]))};
  }
}

__device__ float Silu(float x) { return x * Reciprocal(1.f + Exp2(-1.44269504f * x)); }

/// Weights of the rays for one channel, which a thread keeps.
struct RayWeights {
  float scale[kGroupNormRays], shift[kGroupNormRays], scale0, shift0;
};
__device__ void LoadRayWeights(const GroupNorm& in, int channel, RayWeights* w) {
  const uint16_t* scale = in.ray_weight + static_cast<int64_t>(channel) * in.rays;
  const uint16_t* shift = scale + static_cast<int64_t>(in.channels) * in.rays;
#pragma unroll
  for (int k = 0; k < kGroupNormRays; ++k) {
    w->scale[k] = k < in.rays ? FromBfloat16(scale[k]) : 0.f;
    w->shift[k] = k < in.rays ? FromBfloat16(shift[k]) : 0.f;
  }
  w->scale0 = 1.f + FromBfloat16(in.ray_bias[channel]);
  w->shift0 = FromBfloat16(in.ray_bias[in.channels + channel]);
}
__device__ float Modulated(float y, const RayWeights& w, const float4* rays) {
  float scale = w.scale0, shift = w.shift0;
#pragma unroll
  for (int k = 0; k < kGroupNormRays; k += 4) {
    const float4 r = rays[k / 4];
    scale = fmaf(w.scale[k], r.x, fmaf(w.scale[k + 1], r.y, scale));
    scale = fmaf(w.scale[k + 2], r.z, fmaf(w.scale[k + 3], r.w, scale));
    shift = fmaf(w.shift[k], r.x, fmaf(w.shift[k + 1], r.y, shift));
    shift = fmaf(w.shift[k + 2], r.z, fmaf(w.shift[k + 3], r.w, shift));
  }
  return fmaf(y, scale, shift);
}

template <bool kModulate>
__global__ void __launch_bounds__(kThreads) GroupNormApplyKernel(GroupNorm in, const GroupNormPair* factors) {
  __shared__ float4 rays[kGroupNormPixelsABlock][kGroupNormRays / 4];
  const int pairs = in.channels / 2, rows = RowsOf(pairs);
  const Chunk chunk = ChunkOf(in);
  const int64_t pixel = chunk.image * in.pixels + chunk.first;
  if constexpr (kModulate) {
    for (int i = static_cast<int>(threadIdx.x); i < chunk.pixels * kGroupNormRays; i += kThreads) {
      const int p = i / kGroupNormRays, k = i % kGroupNormRays;
      reinterpret_cast<float*>(rays[p])[k] = k < in.rays ? FromBfloat16(in.ray_maps[(pixel + p) * in.rays + k]) : 0.f;
    }
    __syncthreads();
  }
  const unsigned* x = Pairs(in.x) + pixel * pairs;
  unsigned* out = Pairs(in.out) + pixel * pairs;
  for (int item = static_cast<int>(threadIdx.x); item < pairs * rows; item += kThreads) {
    const int pair = item % pairs;
    const GroupNormPair fa = factors[chunk.image * in.channels + 2 * pair];
    const GroupNormPair fb = factors[chunk.image * in.channels + 2 * pair + 1];
    RayWeights wa, wb;
    if constexpr (kModulate) LoadRayWeights(in, 2 * pair, &wa), LoadRayWeights(in, 2 * pair + 1, &wb);
    for (int p0 = item / pairs; p0 < chunk.pixels; p0 += kAtOnce * rows) {
      unsigned read[kAtOnce];
#pragma unroll
      for (int k = 0; k < kAtOnce; ++k) {
        const int p = p0 + k * rows;
        if (p < chunk.pixels) read[k] = x[static_cast<int64_t>(p) * pairs + pair];
      }
#pragma unroll
      for (int k = 0; k < kAtOnce; ++k) {
        const int p = p0 + k * rows;
        if (p >= chunk.pixels) break;
        const float2 v = Unpack(read[k]);
        float a = fmaf(v.x, fa.a, fa.b), b = fmaf(v.y, fb.a, fb.b);
        if (in.silu) a = Silu(a), b = Silu(b);
        if constexpr (kModulate) a = Modulated(a, wa, rays[p]), b = Modulated(b, wb, rays[p]);
        out[static_cast<int64_t>(p) * pairs + pair] = Pack({a, b});
      }
    }
  }
}

}  // namespace

void RunGroupNorm(const GroupNorm& in, const GroupNormScratch& scratch, cudaStream_t stream) {
  const LaunchShape chunks{in.images * GroupNormChunks(in), kThreads};
  Launch("the sums of a group norm", GroupNormSumsKernel, chunks, stream, in, scratch.sums);
  Launch("the factors of a group norm", GroupNormFactorsKernel, {in.images, kFactorThreads}, stream, in, scratch.sums,
         scratch.factors);
  auto* apply = in.rays > 0 ? GroupNormApplyKernel<true> : GroupNormApplyKernel<false>;
  Launch("a group norm", apply, chunks, stream, in, scratch.factors);
}

}  // namespace oraclegs::cuda
