#pragma once

#include <cstddef>
#include <optional>

#include "oraclegs/depth/depth_map.h"
#include "oraclegs/depth/plane.h"

namespace oraclegs {

/// When two pixels of two views are one point.
struct SamePoint {
  float relative_depth = 0.01f;  ///< largest difference of depth
  float pixels = 1.5f;           ///< largest distance after a round trip
  float min_confidence = 0.3f;   ///< of the other view's depth
};

/// The pixel of another view that shows the point at (u, v, inverse depth) of this one; nothing where the other view
/// does not see it or disagrees. `there` maps from this view to the other, `back` from there to here.
std::optional<size_t> FindPixel(const DepthMap& other, const PixelMap& there, const PixelMap& back,
                                const Eigen::Vector3f& uvw, const SamePoint& same);

/// (u, v, inverse depth) of a pixel, at its centre.
Eigen::Vector3f PixelOf(const DepthMap& map, size_t index);

}  // namespace oraclegs
