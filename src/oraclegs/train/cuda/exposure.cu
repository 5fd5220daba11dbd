#include "oraclegs/train/cuda/exposure.h"

#include "oraclegs/core/cuda/launch.h"
#include "oraclegs/loss/cuda/sums-inl.cuh"
#include "oraclegs/train/train_math.h"

namespace oraclegs::cuda {
namespace {

constexpr int kNumbers = kExposureNumbers;

__global__ void ApplyExposure(ExposurePixels in) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * kSumThreads + threadIdx.x;
  if (i >= in.pixels) return;
  const float r = in.image[3 * i], g = in.image[3 * i + 1], b = in.image[3 * i + 2];
  for (int k = 0; k < 3; ++k) {
    const float* row = in.map + 4 * k;
    in.shown[3 * i + k] = row[0] * r + row[1] * g + row[2] * b + row[3];
  }
}

__global__ void ExposureBackward(ExposurePixels in) {
  __shared__ double shared[kSumWarps];
  const int thread = static_cast<int>(threadIdx.x);
  const int64_t begin = static_cast<int64_t>(blockIdx.x) * kExposurePixelsABlock;
  double sums[kNumbers] = {};
  for (int k = thread; k < kExposurePixelsABlock && begin + k < in.pixels; k += kSumThreads) {
    const float* x = in.image + 3 * (begin + k);
    float* to = in.grad + 3 * (begin + k);
    const float g[3] = {to[0], to[1], to[2]};
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) sums[4 * row + column] += static_cast<double>(g[row] * x[column]);
      sums[4 * row + 3] += static_cast<double>(g[row]);
      to[row] = in.map[row] * g[0] + in.map[4 + row] * g[1] + in.map[8 + row] * g[2];
    }
  }
  for (int n = 0; n < kNumbers; ++n) {
    const double sum = BlockSum(sums[n], thread, shared);
    if (thread == 0) in.sums[kNumbers * static_cast<int64_t>(blockIdx.x) + n] = sum;
  }
}

/// Inverts the 3x3 part of a 3x4 matrix by cofactors. Returns the determinant.
__device__ double Invert(const double* a, double* inverse) {
  const auto at = [a](int row, int column) { return a[4 * (row % 3) + column % 3]; };
  double determinant = 0;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      inverse[3 * column + row] =
          at(row + 1, column + 1) * at(row + 2, column + 2) - at(row + 1, column + 2) * at(row + 2, column + 1);
    }
    if (row == 0) determinant = at(0, 0) * inverse[0] + at(0, 1) * inverse[3] + at(0, 2) * inverse[6];
  }
  for (int k = 0; k < 9; ++k) inverse[k] /= determinant;
  return determinant;
}

/// Maps (A, b) to (A M^-1, b - A M^-1 c) for the mean map (M, c).
__device__ void MoveGauge(const double* inverse, const double* mean, float* map) {
  double fixed[kNumbers];
  for (int row = 0; row < 3; ++row) {
    double shift = 0;
    for (int column = 0; column < 3; ++column) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) sum += static_cast<double>(map[4 * row + k]) * inverse[3 * k + column];
      fixed[4 * row + column] = sum;
      shift += sum * mean[4 * column + 3];
    }
    fixed[4 * row + 3] = static_cast<double>(map[4 * row + 3]) - shift;
  }
  for (int k = 0; k < kNumbers; ++k) map[k] = static_cast<float>(fixed[k]);
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
  if (thread == 0) {
    double squares = 0;
    for (int k = 0; k < kNumbers; ++k) {
      const double offset = static_cast<double>(map[k]) - (k % 5 == 0 ? 1 : 0);  // the identity has ones at 0, 5, 10
      squares += offset * offset;
      gradient[k] += in.weight * offset;
    }
    *in.regularizer = 0.5 * in.weight * squares;
  }
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
    const double determinant = Invert(mean, inverse);
    has_inverse = (determinant < 0 ? -determinant : determinant) > kMinExposureDeterminant;
    if (!has_inverse) *in.regularizer = NAN;
  }
  __syncthreads();
  if (!has_inverse) return;
  for (int view = thread; view < rows.views; view += kSumThreads) MoveGauge(inverse, mean, rows.maps + kNumbers * view);
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
