#pragma once
// COLMAP's sparse model in memory: cameras, images and points. colmap_files.h parses its files,
// read_colmap.h reads a folder of them.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "oraclegs/camera/intrinsics.h"

namespace oraclegs {

/// The way out for a camera model that is not known here.
inline constexpr const char* kUndistortNewerModels =
    "let the COLMAP that made it write photos without distortion (colmap image_undistorter --image_path PHOTOS "
    "--input_path MODEL --output_path NEW) and name the folder NEW";

using ColmapCameras = std::map<uint32_t, Intrinsics>;  ///< by camera id

struct ColmapImage {
  uint32_t id = 0;
  std::string name;  ///< path below the image folder
  uint32_t camera_id = 0;
  Eigen::Isometry3d cam_from_world = Eigen::Isometry3d::Identity();
};

struct ColmapPoint {
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
  std::array<uint8_t, 3> rgb{};
  double reprojection_error = 0;    ///< pixels, mean over its track, as stored
  std::vector<uint32_t> image_ids;  ///< its track, as stored
};

/// Where a point was seen.
struct ColmapObservation {
  uint32_t image_id = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

/// A point to be written, with what its track needs.
struct ColmapTrack {
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
  std::array<uint8_t, 3> rgb{};
  std::vector<ColmapObservation> observations;
};

/// The pose of a (w, x, y, z) quaternion of any length and a translation. Throws InputError "FILE: image 'NAME' ..."
/// for numbers that are not finite and for the zero quaternion.
Eigen::Isometry3d PoseFromQuaternion(const std::array<double, 4>& wxyz, const Eigen::Vector3d& translation,
                                     const std::string& file, const std::string& image);

}  // namespace oraclegs
