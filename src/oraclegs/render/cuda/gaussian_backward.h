#pragma once
// Stage 4: from the records of pairs to the raw parameters (spec/gaussian_core.md 6.2 to 6.5).

#include "oraclegs/gaussians/gaussian_rows.h"
#include "oraclegs/render/cuda/splats.h"

namespace oraclegs::cuda {

/// What the stage reads. Valid until the next Forward.
struct GaussianBackwardInput {
  View view;
  Parameters parameters;
  const uint32_t *begins, *counts;  ///< [n] pairs of each Gaussian: number of the first, how many
  const float* records;             ///< [pairs, kRecord], see BlendBackward
};

/// Writes all rows of `grads`; of sh only the coefficients of the active degree.
void WriteGaussianGrads(const GaussianBackwardInput& in, const GaussianRows& grads, cudaStream_t stream);

}  // namespace oraclegs::cuda
