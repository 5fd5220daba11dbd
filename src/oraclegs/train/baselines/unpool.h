#pragma once
// Proximity-guided Gaussian unpooling of FSGS [Zhu 2024] (section 3.2, eq. 3 and 4): new Gaussians in the gaps of a
// sparse start.

#include <cstdint>

#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// What makes a Gaussian a source of new ones. The paper and its public code differ.
struct UnpoolOptions {
  /// The proximity score: the mean over the K = 3 nearest other centers of ...
  enum class Score {
    kDistance,         ///< their distance, world units: the paper, eq. 4
    kSquaredDistance,  ///< its square: what the public code compares
  };
  enum class Color {
    kNone,         ///< all SH coefficients 0, which is gray: the paper and the code
    kDestination,  ///< those of the neighbor
  };

  Score score = Score::kDistance;
  double threshold = 10;  ///< sources have a larger score
  double min_scale = 0;   ///< and a larger greatest standard deviation, world units
  Color color = Color::kNone;

  /// The paper: mean distance above t_prox = 10 world units, Gaussians of any size.
  static UnpoolOptions Paper() { return {}; }
  /// The code: mean squared distance above 5 * extent, greatest standard deviation above extent; extent is 1.1 times
  /// the largest distance of a training camera from their mean (SpatialExtent).
  static UnpoolOptions PublicCode(double extent) { return {Score::kSquaredDistance, 5 * extent, extent, Color::kNone}; }
};

/// Adds a Gaussian at the middle of each edge from a source to each of its 3 nearest neighbors, its destinations: scale
/// and opacity of the destination, no rotation, color by `options`, and zero rows in the moments. Where there would be
/// more than max_gaussians in all, sources of the largest score come first and the last one may lose its farther
/// destinations. Nothing happens where there are fewer than 4 Gaussians. Returns how many were added. The buffers are
/// grown in place where their memory has room (Buffer::GrownTo).
///
/// FSGS: every 100 iterations from 500, by the code only before 2000. (The code pairs the sources with destinations of
/// other sources where there is more than one; this follows the paper.)
///
/// Throws ShapeError where moments do not fit. The same for any number of threads.
struct UnpoolTarget {
  Gaussians* gaussians;
  Gaussians* first_moments;
  Gaussians* second_moments;
};
int64_t UnpoolGaussians(const UnpoolOptions& options, int64_t max_gaussians, const UnpoolTarget& target);

}  // namespace oraclegs
