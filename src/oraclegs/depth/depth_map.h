#pragma once
// Depth map of one view, and corresponding pixels of two views.

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/depth/plane.h"

namespace oraclegs {

/// Depth, normals and confidence of one view's pixels, row by row, width * height of the camera; or of none of them, of
/// a view whose depth was not looked for.
struct DepthMap {
  std::string name;  ///< name of the view
  Camera camera;
  std::vector<float> inv_depth;          ///< 1/z, 1/world unit; 0 = unknown
  std::vector<Eigen::Vector3f> normals;  ///< unit, camera frame, toward the camera; zero where unknown
  std::vector<float> confidence;         ///< [0, 1], probability that inv_depth is right; 0 where unknown
  bool monocular = false;                ///< depths below kConfident come from a network, aligned, and not from stereo

  size_t size() const { return inv_depth.size(); }
};

/// Confidence from which a depth is called confident (docs/method.md#depth-confidence).
inline constexpr float kConfident = 0.5f;

/// Fraction of confident pixels.
double ConfidentShare(const DepthMap& map);

/// Limits within which two pixels of two views are one point.
struct SamePoint {
  float relative_depth = 0.01f;  ///< largest relative difference of depth
  float pixels = 1.5f;           ///< largest distance after a round trip, pixels
  float min_confidence = 0.3f;   ///< least confidence of the other view's depth
};

/// The pixel of another view that shows the point at (u, v, inverse depth) of this one; nullopt where the other view
/// does not see it, disagrees or has no depth. `there` maps from this view to the other, `back` from there to here.
std::optional<size_t> FindPixel(const DepthMap& other, const PixelMap& there, const PixelMap& back,
                                const Eigen::Vector3f& uvw, const SamePoint& same);

/// (u, v, inverse depth) of a pixel, at its center.
Eigen::Vector3f PixelOf(const DepthMap& map, size_t index);

/// Relative change of the inverse depth per pixel to the right and downward on the plane through a pixel; nullopt where
/// the plane does not face the camera.
std::optional<Eigen::Vector2f> RelativeSlope(const DepthMap& map, size_t index);

}  // namespace oraclegs
