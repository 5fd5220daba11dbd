#include "oraclegs/train/cuda/step.h"

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/loss/cuda/sums-inl.cuh"
#include "oraclegs/train/cuda/step-inl.cuh"

namespace oraclegs::cuda {
namespace {

static_assert(kStepBlock == kSumThreads);

__global__ void SumRegularizers(RegularizerInput in) {
  __shared__ double shared[kSumThreads];
  const int thread = static_cast<int>(threadIdx.x);
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kStepBlock + thread;
  double opacity = 0, scale = 0;
  if (i < in.count) {
    opacity = Sigmoid(in.params.opacity_logits[i]);
    for (int k = 0; k < 3; ++k) scale += ExpClamped(in.params.log_scales[3 * i + k]);
  }
  opacity = BlockSum(opacity, thread, shared);
  scale = BlockSum(scale, thread, shared);
  if (thread == 0) in.sums[blockIdx.x] = {opacity, scale};
}

__global__ void MoveSplats(StepConstants step, GaussianRows grads, int64_t count) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kStepBlock + threadIdx.x;
  if (i < count) MoveSplat(step, i, LoadRow(grads, i));
}

__global__ void MoveColors(StepConstants step, GaussianRows grads, int64_t count) {
  const int pieces = (step.adam.sh_active + 3) / 4;
  const int64_t at = static_cast<int64_t>(blockIdx.x) * kStepBlock + threadIdx.x;
  if (at >= count * pieces) return;
  const int64_t i = at / pieces;
  const int first = static_cast<int>(at % pieces) * 4;
  MoveColor(step, i, first, *reinterpret_cast<const Four*>(grads.sh + i * kShFloats + first));
}

__global__ void AddNoiseToAll(NoiseInput in) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kStepBlock + threadIdx.x;
  if (i >= in.count) return;
  SplatRow row = LoadRow(in.params, i);
  AddNoiseTo(in.noise, static_cast<uint32_t>(i), &row);
  for (int k = 0; k < 3; ++k) in.params.means[3 * i + k] = row.mean[k];
}

}  // namespace

void RunRegularizerSums(const RegularizerInput& in, cudaStream_t stream) {
  Launch("the sums of the regularisers", SumRegularizers, LaunchShape::For(in.count, kStepBlock), stream, in);
}

void RunStep(const StepConstants& step, const GaussianRows& grads, int64_t count, cudaStream_t stream) {
  Launch("Adam", MoveSplats, LaunchShape::For(count, kStepBlock), stream, step, grads, count);
  const int64_t pieces = (step.adam.sh_active + 3) / 4;
  Launch("Adam of colours", MoveColors, LaunchShape::For(count * pieces, kStepBlock), stream, step, grads, count);
}

void RunNoise(const NoiseInput& in, cudaStream_t stream) {
  Launch("noise", AddNoiseToAll, LaunchShape::For(in.count, kStepBlock), stream, in);
}

}  // namespace oraclegs::cuda
