#include "oraclegs/networks/cuda/kernels.h"

#include "oraclegs/core/cuda/fast_math-inl.cuh"
#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/networks/cuda/bfloat16-inl.cuh"

namespace oraclegs::cuda {
namespace {

constexpr int kThreads = 256;
constexpr int kRowsABlock = 8;

/// x Phi(x) = max(x, 0) - |x| erfc(|x| / sqrt 2) / 2, with erfc by formula 7.1.26 of Abramowitz and Stegun.
__device__ float Gelu(float x) {
  const float away = fabsf(x);
  const float t = Reciprocal(fmaf(0.3275911f * 0.70710678f, away, 1.f));
  float tail = fmaf(t, 1.061405429f, -1.453152027f);
  tail = fmaf(t, tail, 1.421413741f);
  tail = fmaf(t, tail, -0.284496736f);
  tail = fmaf(t, tail, 0.254829592f) * t;
  tail *= Exp2(-0.5f * 1.44269504f * x * x);
  return fmaf(-0.5f * away, tail, fmaxf(x, 0.f));
}

__device__ unsigned Gated(unsigned value, unsigned gate) {
  const float2 a = Unpack(value), g = Unpack(gate);
  return Pack({a.x * Gelu(g.x), a.y * Gelu(g.y)});
}

__global__ void GatedGeluKernel(GatedGelu in) {
  const int vectors = in.width / 8;  // 16 bytes each
  const int64_t first = static_cast<int64_t>(blockIdx.x) * kRowsABlock;
  const auto rows = static_cast<int>(in.rows - first < kRowsABlock ? in.rows - first : int64_t{kRowsABlock});
  const auto* both = reinterpret_cast<const uint4*>(in.both) + first * 2 * vectors;
  auto* out = reinterpret_cast<uint4*>(in.out) + first * vectors;
  for (int i = static_cast<int>(threadIdx.x); i < rows * vectors; i += kThreads) {
    const int row = i / vectors;
    const uint4 a = both[i + row * vectors], g = both[i + (row + 1) * vectors];
    out[i] = make_uint4(Gated(a.x, g.x), Gated(a.y, g.y), Gated(a.z, g.z), Gated(a.w, g.w));
  }
}

}  // namespace

void RunGatedGelu(const GatedGelu& in, cudaStream_t stream) {
  Launch("the gate of a feed-forward layer", GatedGeluKernel, {(in.rows + kRowsABlock - 1) / kRowsABlock, kThreads},
         stream, in);
}

}  // namespace oraclegs::cuda
