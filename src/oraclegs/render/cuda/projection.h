#pragma once
// Stage 1, one thread a Gaussian: projection and color (docs/method.md#projection, #spherical-harmonics).

#include "oraclegs/render/cuda/splats.h"

namespace oraclegs::cuda {

/// Fills rects[n] (empty where invisible) and, where they are not empty, splats[n].
void ProjectSplats(const SplatCamera<float>& camera, const GaussianParameters& parameters, Splat* splats,
                   TileRect* rects, cudaStream_t stream);

}  // namespace oraclegs::cuda
