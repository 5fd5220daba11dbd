#include "oraclegs/train/cuda/exposure.h"

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/core/cuda/sums-inl.cuh"
#include "oraclegs/train/exposure_math.h"
#include "oraclegs/train/train_math.h"

namespace oraclegs::cuda {
namespace {

constexpr int kNumbers = kExposureNumbers;

__global__ void ApplyExposure(ExposurePixels in) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kSumThreads + threadIdx.x;
  if (i >= in.pixels) return;
  ShowPixel(in.map, in.image + 3 * i, in.shown + 3 * i);
}

__global__ void ExposureBackward(ExposurePixels in) {
  __shared__ double shared[kSumWarps];
  const int thread = static_cast<int>(threadIdx.x);
  const int64_t begin = static_cast<int64_t>(blockIdx.x) * kExposurePixelsABlock;
  double sums[kNumbers] = {};
  for (int k = thread; k < kExposurePixelsABlock && begin + k < in.pixels; k += kSumThreads) {
    ShowPixelBackward(in.map, in.image + 3 * (begin + k), in.grad + 3 * (begin + k), sums);
  }
  for (int n = 0; n < kNumbers; ++n) {
    const double sum = BlockSum(sums[n], thread, shared);
    if (thread == 0) in.sums[kNumbers * static_cast<int64_t>(blockIdx.x) + n] = sum;
  }
}

/// Steps one map. Runs in one block; thread k < 12 has entry k of the photo's map.
__global__ void StepExposures(ExposureStepInput in) {
  __shared__ double shared[kSumWarps], gradient[kNumbers], mean[kNumbers], inverse[9];
  __shared__ bool has_inverse;
  const int thread = static_cast<int>(threadIdx.x);
  const ExposureRows& rows = in.rows;
  float* map = rows.maps + kNumbers * in.view;
  for (int n = 0; n < kNumbers; ++n) {
    double sum = 0;
    for (int64_t block = thread; block < in.blocks; block += kSumThreads) sum += in.sums[kNumbers * block + n];
    sum = BlockSum(sum, thread, shared);
    if (thread == 0) gradient[n] = sum;
  }
  if (thread == 0) *in.regularizer = RegularizeExposure(map, in.weight, gradient);
  if (!in.moves) return;  // the same for all threads
  __syncthreads();
  if (thread < kNumbers) {
    const int64_t at = kNumbers * static_cast<int64_t>(in.view) + thread;
    ExposureEntry entry{rows.maps[at], rows.m[at], rows.v[at]};
    StepExposure(gradient[thread], static_cast<double>(rows.steps[in.view] + 1), in.learning_rate, &entry);
    rows.maps[at] = entry.value;
    rows.m[at] = entry.m;
    rows.v[at] = entry.v;
  }
  __syncthreads();
  if (thread == 0) ++rows.steps[in.view];
  if (thread < kNumbers) {
    double sum = 0;
    for (int view = 0; view < rows.views; ++view) sum += static_cast<double>(rows.maps[kNumbers * view + thread]);
    mean[thread] = sum / rows.views;
  }
  __syncthreads();
  if (thread == 0) {
    const double determinant = InvertExposure(mean, inverse);
    has_inverse = (determinant < 0 ? -determinant : determinant) > kMinExposureDeterminant;
    if (!has_inverse) *in.regularizer = NAN;
  }
  __syncthreads();
  if (!has_inverse) return;
  for (int view = thread; view < rows.views; view += kSumThreads)
    MoveExposureGauge(inverse, mean, rows.maps + kNumbers * view);
}

}  // namespace

void RunExposureApply(const ExposurePixels& in, cudaStream_t stream) {
  Launch("exposure", ApplyExposure, LaunchShape::For(in.pixels, kSumThreads), stream, in);
}

void RunExposureBackward(const ExposurePixels& in, cudaStream_t stream) {
  Launch("the gradient of the exposure", ExposureBackward, {ExposureBlocks(in.pixels), kSumThreads}, stream, in);
}

void RunExposureStep(const ExposureStepInput& in, cudaStream_t stream) {
  Launch("the step of the exposures", StepExposures, {1, kSumThreads}, stream, in);
}

}  // namespace oraclegs::cuda
