#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "oraclegs/camera/camera.h"

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

}  // namespace oraclegs
