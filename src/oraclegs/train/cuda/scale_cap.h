#pragma once
// The scale cap of train/scale_cap.h on a GPU.

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/gaussians/gaussian_rows.h"

namespace oraclegs::cuda {

/// Input of RunCapScales, all in device memory.
struct ScaleCapInput {
  GaussianRows params;
  int64_t count = 0;
  const float* centers = nullptr;  ///< [num_centers,3], of the photos' cameras
  int num_centers = 0;
  float log_share = 0;  ///< ln of (largest scale / distance)
};

/// Queues the cap. Does nothing without centers.
void RunCapScales(const ScaleCapInput& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
