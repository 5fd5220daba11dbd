#pragma once
// Exposure maps on a GPU (see train/exposure.h). The maps, their moments and their steps stay there.

#include <cuda_runtime.h>

#include <cstdint>

namespace oraclegs::cuda {

inline constexpr int kExposurePixelsABlock = 2048;
inline constexpr int kExposureNumbers = 12;  ///< entries of a map, [A b] row by row

inline int64_t ExposureBlocks(int64_t pixels) { return (pixels + kExposurePixelsABlock - 1) / kExposurePixelsABlock; }

/// Exposure maps of all photos with their Adam state, in device memory.
struct ExposureRows {
  int views = 0;
  float *maps = nullptr, *m = nullptr, *v = nullptr;  ///< [views,12]
  int64_t* steps = nullptr;                           ///< [views]
};

struct ExposurePixels {
  int64_t pixels = 0;
  const float* map = nullptr;    ///< [12] of the photo
  const float* image = nullptr;  ///< [H,W,3] as rendered
  float* shown = nullptr;        ///< [H,W,3] receives A image + b
  float* grad = nullptr;         ///< [H,W,3] dL/d(shown), becomes dL/d(image)
  double* sums = nullptr;        ///< [ExposureBlocks,12] receives sums of dL/d(map)
};

/// Queues shown = A image + b.
void RunExposureApply(const ExposurePixels& in, cudaStream_t stream);
/// Queues the adjoint of RunExposureApply.
void RunExposureBackward(const ExposurePixels& in, cudaStream_t stream);

struct ExposureStepInput {
  ExposureRows rows;
  int view = 0;
  const double* sums = nullptr;  ///< [blocks,12], written by RunExposureBackward
  int64_t blocks = 0;
  double learning_rate = 0;
  double weight = 0;              ///< factor of the regularization toward identity
  bool moves = true;              ///< false in the last iteration
  double* regularizer = nullptr;  ///< receives weight / 2 |map - identity|^2; NaN when the mean of the maps is singular
};
/// Queues a step of Adam for one photo's map, then moves the mean of all maps back to the identity.
void RunExposureStep(const ExposureStepInput& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
