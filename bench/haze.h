#pragma once
// How much of what a splat shows lies off the surface, where the true depth is known.

#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/render/render.h"

namespace oraclegs {

/// Sums over the pixels that have a true depth and show something.
struct Haze {
  size_t pixels = 0;
  double before = 0;  ///< share of the blending weight of Gaussians nearer than 0.98 of the true depth
  double behind = 0;  ///< and of those farther than 1.02 of it
};

/// Measures a view. A Gaussian lies where its center does, along the optical axis. `depth`: [H*W] true depth in units
/// of the Gaussians, 0 = none. `options` give the antialiasing.
Haze HazeOf(const Gaussians& gaussians, const Camera& camera, const std::vector<float>& depth, RenderOptions options);

}  // namespace oraclegs
