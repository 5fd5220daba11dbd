#pragma once
// COLMAP's sparse model on disk: cameras, images and points3D as .bin or .txt, in the layout of COLMAP 3.8 (newer
// versions write the same three files). colmap_binary.h and colmap_text.h parse the two encodings.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/camera/intrinsics.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

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

/// True when `dir` holds the cameras and images of a model, as .bin or .txt.
bool IsColmapModel(const std::filesystem::path& dir);

/// One part of a model alone; no points when it has no points3D file. Throws InputError as ReadColmapScene does.
ColmapCameras ReadColmapCameras(const std::filesystem::path& model_dir);
std::vector<ColmapImage> ReadColmapImages(const std::filesystem::path& model_dir);
std::vector<ColmapPoint> ReadColmapPoints(const std::filesystem::path& model_dir);

/// A whole model as a scene: root = model_dir, views (as_stored) sorted by name with images looked up below image_dir,
/// points with the views that saw them. `listener` hears of views without an image file and of points that are dropped
/// (not finite, or seen by no view). Throws InputError naming the file: missing, truncated, a camera id or model that
/// is unknown, bad intrinsics, a pose that is not one, two images of one name, no image file at all.
Scene ReadColmapScene(const std::filesystem::path& model_dir, const std::filesystem::path& image_dir,
                      const Listener& listener);

/// Where a point was seen.
struct ColmapSight {
  uint32_t image_id = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};

/// A point to be written, with what its track needs.
struct ColmapTrack {
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();
  std::array<uint8_t, 3> rgb{};
  std::vector<ColmapSight> sights;
};

/// Writes cameras.txt, images.txt and points3D.txt; the keypoints are where the points were seen. Without points it is
/// a model of known poses for `colmap point_triangulator`. Numbers read back to the same bits, poses to rounding.
/// Throws InputError for an image name with a space or line break, which COLMAP's text reader would cut short, and
/// RunError when writing fails.
void WriteColmapText(const std::filesystem::path& dir, const ColmapCameras& cameras,
                     const std::vector<ColmapImage>& images, const std::vector<ColmapTrack>& points = {});

/// The pose of a (w, x, y, z) quaternion of any length and a translation. Throws InputError "FILE: image 'NAME' ..."
/// for numbers that are not finite and for the zero quaternion.
Eigen::Isometry3d PoseFromQuaternion(const std::array<double, 4>& wxyz, const Eigen::Vector3d& translation,
                                     const std::string& file, const std::string& image);

}  // namespace oraclegs
