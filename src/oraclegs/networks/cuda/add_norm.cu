// A warp holds a row in registers: lane p % 32 has pair p.

#include "oraclegs/networks/cuda/kernels.h"

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/networks/cuda/bfloat16-inl.cuh"

namespace oraclegs::cuda {
namespace {

constexpr int kThreads = 256;
constexpr int kRowsAWarp = 4;  // rows a warp handles, so that weights and shifts are read once for all
constexpr int kRowsABlock = kRowsAWarp * kThreads / kWarp;

/// sum += row; kPairs: the most pairs that a lane holds.
template <int kPairs>
__device__ void Accumulate(const unsigned* row, int lane, int pairs, float2* sum) {
#pragma unroll
  for (int k = 0; k < kPairs; ++k) {
    const int p = k * kWarp + lane;
    if (p >= pairs) continue;
    const float2 more = Unpack(row[p]);
    sum[k].x += more.x, sum[k].y += more.y;
  }
}

template <int kPairs>
__global__ void __launch_bounds__(kThreads, kPairs > 10 ? 2 : 3) AddNormKernel(AddNorm in) {
  const int lane = static_cast<int>(threadIdx.x) % kWarp, warp = static_cast<int>(threadIdx.x) / kWarp;
  const int pairs = in.width / 2;
  const bool has_norm = in.normed != nullptr;
  unsigned weight[kPairs], bias[kPairs];
#pragma unroll
  for (int k = 0; k < kPairs; ++k) {
    const int p = k * kWarp + lane;
    if (!has_norm || p >= pairs) continue;
    weight[k] = Pairs(in.weight)[p], bias[k] = Pairs(in.bias)[p];
  }
#pragma unroll 1
  for (int r = 0; r < kRowsAWarp; ++r) {
    const int64_t row = static_cast<int64_t>(blockIdx.x) * kRowsABlock + r * (kThreads / kWarp) + warp;
    if (row >= in.rows) return;
    const int64_t at = row * pairs;
    const unsigned* vector = nullptr;
    if (in.vectors != nullptr) {
      const unsigned group = static_cast<unsigned>(row) / static_cast<unsigned>(in.rows_a_vector);
      vector = Pairs(in.vectors) + static_cast<int64_t>(group) * pairs;
    }
    // All reads come before the first write, which the compiler may not move them across.
    float2 sum[kPairs];
#pragma unroll
    for (int k = 0; k < kPairs; ++k) {
      const int p = k * kWarp + lane;
      sum[k] = p < pairs ? Unpack(Pairs(in.x)[at + p]) : float2{0, 0};
    }
    if (in.added != nullptr) Accumulate<kPairs>(Pairs(in.added) + at, lane, pairs, sum);
    if (vector != nullptr) Accumulate<kPairs>(vector, lane, pairs, sum);
    float total = 0;
#pragma unroll
    for (int k = 0; k < kPairs; ++k) {
      const int p = k * kWarp + lane;
      if (in.sum != nullptr && p < pairs) Pairs(in.sum)[at + p] = Pack(sum[k]);
      total += sum[k].x + sum[k].y;
    }
    if (!has_norm) continue;
    const float mean = WarpSum(total) / static_cast<float>(in.width);
    float squares = 0;
#pragma unroll
    for (int k = 0; k < kPairs; ++k) {
      if (k * kWarp + lane >= pairs) continue;
      sum[k].x -= mean, sum[k].y -= mean;
      squares += sum[k].x * sum[k].x + sum[k].y * sum[k].y;
    }
    const float factor = 1.f / sqrtf(WarpSum(squares) / static_cast<float>(in.width) + in.eps);
#pragma unroll
    for (int k = 0; k < kPairs; ++k) {
      const int p = k * kWarp + lane;
      if (p >= pairs) continue;
      const float2 w = Unpack(weight[k]), b = Unpack(bias[k]);
      Pairs(in.normed)[at + p] = Pack({fmaf(sum[k].x * factor, w.x, b.x), fmaf(sum[k].y * factor, w.y, b.y)});
    }
  }
}

}  // namespace

void RunAddNorm(const AddNorm& in, cudaStream_t stream) {
  const LaunchShape shape{(in.rows + kRowsABlock - 1) / kRowsABlock, kThreads};
  const int pairs_a_lane = (in.width / 2 + kWarp - 1) / kWarp;
  auto* kernel = AddNormKernel<kAddNormWidth / 2 / kWarp>;
  if (pairs_a_lane <= 10) kernel = AddNormKernel<10>;
  if (pairs_a_lane <= 5) kernel = AddNormKernel<5>;
  Launch("a sum and its layer norm", kernel, shape, stream, in);
}

}  // namespace oraclegs::cuda
