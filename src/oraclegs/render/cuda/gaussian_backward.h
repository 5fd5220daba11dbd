#pragma once
// Stage 4: from the records of pairs to the raw parameters (docs/method.md#gaussian-gradient).

#include <cuda_runtime.h>

#include "oraclegs/gaussians/gaussian_rows.h"
#include "oraclegs/render/cuda/splats.h"

namespace oraclegs::cuda {

/// Writes all rows of `grads`; of sh only the coefficients of the active degree.
void WriteGaussianGrads(const GaussianBackwardInput& in, const GaussianRows& grads);

}  // namespace oraclegs::cuda
