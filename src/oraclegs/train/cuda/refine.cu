#include "oraclegs/train/cuda/refine.h"

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/train/cuda/scan-inl.cuh"
#include "oraclegs/train/train_math.h"

namespace oraclegs::cuda {
namespace {

constexpr double kWeightUnit = 68719476736.0;  // 2^36: 10^8 opacities of 1 stay below 2^63
constexpr int kNoSource = -1;

/// Weight of an opacity; 0, which is never drawn, for NaN.
__device__ uint64_t WeightOf(double opacity) {
  return opacity > 0 ? static_cast<uint64_t>(opacity * kWeightUnit + 0.5) : 0;
}

__device__ bool IsDead(double opacity) { return !(opacity > static_cast<double>(kDeadOpacity)); }

/// Weighs the living Gaussians; ranks count the dead.
__global__ void WeighLiving(RefineInput in) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kScanBlock + threadIdx.x;
  if (i >= in.count) return;
  const double opacity = OpacityOf(in.params.opacity_logits[i]);
  in.scratch.weights[i] = IsDead(opacity) ? 0 : WeightOf(opacity);
  in.scratch.ranks[i] = IsDead(opacity) ? 1 : 0;
  in.scratch.draws[i] = 0;
}

__global__ void WeighAll(RefineInput in) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kScanBlock + threadIdx.x;
  if (i >= in.count) return;
  in.scratch.weights[i] = WeightOf(OpacityOf(in.params.opacity_logits[i]));
  in.scratch.draws[i] = 0;
}

/// The draw of this number: the first Gaussian whose running sum exceeds the drawn fraction of the total.
__device__ int DrawSource(const RefineInput& in, RandomStream stream, uint64_t number) {
  const uint64_t counter = static_cast<uint64_t>(in.iteration) << 32 | number;
  const double total = static_cast<double>(in.scratch.weights[in.count - 1]);
  const uint64_t wanted = static_cast<uint64_t>(DrawUniform(in.seed, stream, counter) * total);
  int64_t low = 0, high = in.count - 1;
  while (low < high) {
    const int64_t middle = low + (high - low) / 2;
    if (in.scratch.weights[middle] > wanted) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return static_cast<int>(low);
}

__global__ void DrawForDead(RefineInput in) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kScanBlock + threadIdx.x;
  if (i >= in.count) return;
  const uint64_t rank = in.scratch.ranks[i], before = i > 0 ? in.scratch.ranks[i - 1] : 0;
  const bool moves = rank != before && in.scratch.weights[in.count - 1] > 0;
  in.scratch.sources[i] = moves ? DrawSource(in, RandomStream::kRelocate, before) : kNoSource;
  if (moves) atomicAdd(in.scratch.draws + in.scratch.sources[i], 1);
}

__global__ void DrawForNew(RefineInput in, int64_t added) {
  const int64_t k = static_cast<int64_t>(blockIdx.x) * kScanBlock + threadIdx.x;
  if (k >= added) return;
  in.scratch.sources[k] = DrawSource(in, RandomStream::kAdd, static_cast<uint64_t>(k));
  atomicAdd(in.scratch.draws + in.scratch.sources[k], 1);
}

__device__ void ZeroWithoutSh(const GaussianRows& rows, int64_t i) {
  for (int k = 0; k < 3; ++k) rows.means[3 * i + k] = rows.log_scales[3 * i + k] = 0;
  for (int k = 0; k < 4; ++k) rows.quats[4 * i + k] = 0;
  rows.opacity_logits[i] = 0;
}

__device__ void ZeroMoments(const MomentRows& moments, int64_t i) {
  ZeroWithoutSh(moments.m, i);
  ZeroWithoutSh(moments.v, i);
  if (moments.sh_m != nullptr) {
    for (int k = 0; k < kShFloats; ++k) moments.sh_m[kShFloats * i + k] = 0;
    for (int k = 0; k < (moments.half() ? kShFloats : 0); ++k) moments.sh_v_half[kShFloats * i + k] = 0;
    if (moments.compact()) moments.sh_v[i] = 0;
    return;
  }
  for (int k = 0; k < kShFloats; ++k) moments.m.sh[kShFloats * i + k] = moments.v.sh[kShFloats * i + k] = 0;
}

__device__ void CopyRow(const GaussianRows& rows, int64_t from, int64_t to) {
  for (int k = 0; k < 3; ++k) {
    rows.means[3 * to + k] = rows.means[3 * from + k];
    rows.log_scales[3 * to + k] = rows.log_scales[3 * from + k];
  }
  for (int k = 0; k < 4; ++k) rows.quats[4 * to + k] = rows.quats[4 * from + k];
  rows.opacity_logits[to] = rows.opacity_logits[from];
  for (int k = 0; k < kShFloats; ++k) rows.sh[kShFloats * to + k] = rows.sh[kShFloats * from + k];
}

/// Gives every drawn source its new opacity and scale, and zero moments.
__global__ void ShareSources(RefineInput in) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kScanBlock + threadIdx.x;
  if (i >= in.count || in.scratch.draws[i] == 0) return;
  const int n = in.scratch.draws[i] < kMaxCopies ? 1 + in.scratch.draws[i] : kMaxCopies;
  const double opacity = OpacityOf(in.params.opacity_logits[i]);
  const Relocated relocated = RelocateBy(opacity, n, in.scratch.choose + n * (kMaxCopies + 1));
  in.params.opacity_logits[i] = static_cast<float>(LogitOf(relocated.opacity));
  const float shrink = static_cast<float>(std::log(relocated.scale_ratio));
  for (int axis = 0; axis < 3; ++axis) in.params.log_scales[3 * i + axis] += shrink;
  ZeroMoments(in.moments, i);
}

/// Copies sources to dead Gaussians. Destinations are distinct and none is a source; a relocated Gaussian keeps its
/// moments.
__global__ void CopyToDead(RefineInput in) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kScanBlock + threadIdx.x;
  if (i < in.count && in.scratch.sources[i] != kNoSource) CopyRow(in.params, in.scratch.sources[i], i);
}

__global__ void CopyToNew(RefineInput in, int64_t added) {
  const int64_t k = static_cast<int64_t>(blockIdx.x) * kScanBlock + threadIdx.x;
  if (k >= added) return;
  CopyRow(in.params, in.scratch.sources[k], in.count + k);
  ZeroMoments(in.moments, in.count + k);
}

}  // namespace

void RunRelocate(const RefineInput& in, cudaStream_t stream) {
  const LaunchShape shape = LaunchShape::For(in.count, kScanBlock);
  Launch("weights of the living", WeighLiving, shape, stream, in);
  LaunchScan({in.scratch.weights, in.count, in.scratch.totals}, stream);
  LaunchScan({in.scratch.ranks, in.count, in.scratch.totals}, stream);
  Launch("draws for the dead", DrawForDead, shape, stream, in);
  Launch("sharing", ShareSources, shape, stream, in);
  Launch("relocation", CopyToDead, shape, stream, in);
}

void RunWeigh(const RefineInput& in, cudaStream_t stream) {
  Launch("weights", WeighAll, LaunchShape::For(in.count, kScanBlock), stream, in);
  LaunchScan({in.scratch.weights, in.count, in.scratch.totals}, stream);
}

void RunGrow(const RefineInput& in, int64_t added, cudaStream_t stream) {
  if (added == 0) return;
  Launch("draws for new ones", DrawForNew, LaunchShape::For(added, kScanBlock), stream, in, added);
  Launch("sharing", ShareSources, LaunchShape::For(in.count, kScanBlock), stream, in);
  Launch("growth", CopyToNew, LaunchShape::For(added, kScanBlock), stream, in, added);
}

}  // namespace oraclegs::cuda
