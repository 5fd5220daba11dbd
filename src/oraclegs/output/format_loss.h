#pragma once
// Loss of a splat in its file, as it is seen.

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/render/render.h"

namespace oraclegs {

/// PSNR in dB of the renders of a splat against those of another from eight sides: 400 x 400 pixels, 60 degrees wide,
/// around the median of the visible Gaussians of `model` at twice their median distance from it. Infinity where all
/// pixels are the same. The splats are on the host and not empty.
double PsnrFromAround(const Gaussians& splat, const Gaussians& model, const RenderOptions& options);

/// Loss of a model that scores `score` dB against photos, when its renders get an error of `psnr` dB, in dB. The two
/// errors are taken as independent, so that their squares add.
double LossOfScore(double score, double psnr);

}  // namespace oraclegs
