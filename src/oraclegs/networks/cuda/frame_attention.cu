// A warp does one head at one pixel: its keys and values lie in shared memory, and each lane has the query of a frame.
// Matrices this small would leave the tensor cores idle; reading memory once decides the speed.

#include "oraclegs/networks/cuda/kernels.h"

#include "oraclegs/core/cuda/fast_math-inl.cuh"
#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/networks/cuda/bfloat16-inl.cuh"

namespace oraclegs::cuda {
namespace {

constexpr int kWidth = kFrameAttentionWidth, kFrames = kFrameAttentionFrames;
constexpr int kWarps = 3;             // warps a block; what fits into 48 KiB
constexpr int kVectors = kWidth / 8;  // vectors of 16 bytes a token
constexpr int kQuads = kWidth / 4;    // float4 a token
static_assert(kFrames <= kWarp);

/// Shared memory of a warp; rows are frames.
struct Shared {
  float4 keys[kFrames][kQuads], values[kFrames][kQuads];
  float weights[kFrames][kWarp];  // weight of each key for each lane's query
};

__device__ void Widen8(const uint4& bits, float4* out) {
  const float2 a = Unpack(bits.x), b = Unpack(bits.y), c = Unpack(bits.z), d = Unpack(bits.w);
  out[0] = make_float4(a.x, a.y, b.x, b.y);
  out[1] = make_float4(c.x, c.y, d.x, d.y);
}
__device__ unsigned Scaled(float a, float b, float factor) { return Pack({a * factor, b * factor}); }

__device__ float Dot(const float4* a, const float4* b) {
  float4 sum = make_float4(0, 0, 0, 0);
#pragma unroll
  for (int i = 0; i < kQuads; ++i) {
    const float4 x = a[i], y = b[i];
    sum.x = fmaf(x.x, y.x, sum.x), sum.y = fmaf(x.y, y.y, sum.y);
    sum.z = fmaf(x.z, y.z, sum.z), sum.w = fmaf(x.w, y.w, sum.w);
  }
  return (sum.x + sum.y) + (sum.z + sum.w);
}

__global__ void __launch_bounds__(kWarps* kWarp) FrameAttentionKernel(FrameAttention in) {
  __shared__ Shared of_warps[kWarps];
  const int lane = static_cast<int>(threadIdx.x) % kWarp, warp = static_cast<int>(threadIdx.x) / kWarp;
  Shared& shared = of_warps[warp];
  const int64_t item = static_cast<int64_t>(blockIdx.x) * kWarps + warp, site = item / in.heads;
  if (site >= in.batch * in.pixels) return;
  // Offsets in vectors of 16 bytes: frame 0 of the head, and the step from frame to frame.
  const int64_t width = int64_t{in.heads} * kVectors, step = in.pixels * width;
  const int64_t token = site / in.pixels * in.frames * in.pixels + site % in.pixels, head = item % in.heads * kVectors;
  const auto* queries = reinterpret_cast<const uint4*>(in.qkv) + 3 * token * width + head;
  const uint4 *keys = queries + width, *values = keys + width;
  for (int i = lane; i < in.frames * kVectors; i += kWarp) {
    const int frame = i / kVectors, part = i % kVectors;
    const int64_t at = 3 * frame * step + part;
    const uint4 key = keys[at], value = values[at];
    Widen8(key, &shared.keys[frame][2 * part]);
    Widen8(value, &shared.values[frame][2 * part]);
  }
  const bool has_query = lane < in.frames;
  float4 row[kQuads];  // the query, then the result
#pragma unroll
  for (int i = 0; i < kVectors; ++i) {
    row[2 * i] = row[2 * i + 1] = make_float4(0, 0, 0, 0);
    if (has_query) Widen8(queries[3 * lane * step + i], &row[2 * i]);
  }
  __syncwarp();
  constexpr float kScale = 0.125f * 1.44269504f;  // 1 / sqrt(kWidth), for powers of two
  float largest = -INFINITY;
  for (int j = 0; j < in.frames; ++j) {
    const float score = kScale * Dot(row, shared.keys[j]);
    shared.weights[j][lane] = score;  // read by this lane alone
    largest = fmaxf(largest, score);
  }
#pragma unroll
  for (int i = 0; i < kQuads; ++i) row[i] = make_float4(0, 0, 0, 0);
  float sum = 0;
  for (int j = 0; j < in.frames; ++j) {
    const float weight = Exp2(shared.weights[j][lane] - largest);
    sum += weight;
#pragma unroll
    for (int i = 0; i < kQuads; ++i) {
      const float4 v = shared.values[j][i];
      row[i].x = fmaf(weight, v.x, row[i].x), row[i].y = fmaf(weight, v.y, row[i].y);
      row[i].z = fmaf(weight, v.z, row[i].z), row[i].w = fmaf(weight, v.w, row[i].w);
    }
  }
  if (!has_query) return;
  const float factor = 1.f / sum;
  uint4* out = reinterpret_cast<uint4*>(in.out) + token * width + head + lane * step;
#pragma unroll
  for (int i = 0; i < kVectors; ++i) {
    const float4 a = row[2 * i], b = row[2 * i + 1];
    out[i] = make_uint4(Scaled(a.x, a.y, factor), Scaled(a.z, a.w, factor), Scaled(b.x, b.y, factor),
                        Scaled(b.z, b.w, factor));
  }
}

}  // namespace

void RunFrameAttention(const FrameAttention& in, cudaStream_t stream) {
  const int64_t items = in.batch * in.pixels * in.heads;
  Launch("attention over frames", FrameAttentionKernel, {(items + kWarps - 1) / kWarps, kWarps * kWarp}, stream, in);
}

}  // namespace oraclegs::cuda
