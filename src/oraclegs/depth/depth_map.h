#pragma once
// The depth of one view, and the pixels of two views that show one point.

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/depth/plane.h"

namespace oraclegs {

/// What is known of the distances in one view. Pixels row by row, width * height of the camera.
struct DepthMap {
  std::string name;  ///< of the view
  Camera camera;
  std::vector<float> inv_depth;          ///< 1/z, 1/world unit; 0 = unknown
  std::vector<Eigen::Vector3f> normals;  ///< unit, camera frame, towards the camera; zero where unknown
  std::vector<float> confidence;         ///< [0, 1], how likely inv_depth is right; 0 where unknown
  bool monocular = false;                ///< depths below kConfident are a network's, aligned, and not stereo's

  size_t size() const { return inv_depth.size(); }
};

/// From this confidence on a depth is called confident (docs/method.md#depth-confidence).
inline constexpr float kConfident = 0.5f;

/// Share of the pixels that are confident.
double ConfidentShare(const DepthMap& map);

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

/// (u, v, inverse depth) of a pixel, at its center.
Eigen::Vector3f PixelOf(const DepthMap& map, size_t index);

}  // namespace oraclegs
