#pragma once
// The cameras of a run as a dataset that other trainers start from.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/frame.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/scene/split.h"

namespace oraclegs {

/// What a dataset is made of.
struct CameraDataset {
  const Scene& scene;  ///< with poses
  const Split& split;  ///< its views are written, all others left out
  ImageOptions image;  ///< gives the size of the images
  std::vector<ScenePoint> points;
  SceneFrame frame = {};  ///< that scene and points are in
};

struct CameraDatasetResult {
  int images = 0;
  size_t points = 0;
};

/// The names of the images in a dataset: the views' own without the folder that all of them are in, with "_" for other
/// folders and for what COLMAP's text format or a shell trips over, ending in .jpg, made unique by a number. In the
/// order of `names`.
std::vector<std::string> DatasetNames(const std::vector<std::string>& names);

/// Writes to `out`, which must be missing or empty and outside the scene:
///   images/NAME.jpg       undistorted, at working size, JPEG 95
///   masks/NAME.jpg.png    of views that have one: 255 = use
///   sparse/0/*.txt        COLMAP's model: PINHOLE cameras, poses, points with tracks
///   sparse_pc.ply         the points, as Nerfstudio's splatfacto reads them; absent without points
///   transforms.json       the same cameras with OpenGL's axes (Nerfstudio, instant-ngp)
///   split.json            names of the training and test views
/// All in the coordinates of the run's point_cloud.ply; applied_transform of transforms.json has what lies between them
/// and the scene's own. The folder appears when it is whole. Throws InputError naming what does
/// not fit, RunError when writing fails, Interrupted.
CameraDatasetResult WriteCameraDataset(const CameraDataset& dataset, const std::filesystem::path& out,
                                       const Listener& listener);

}  // namespace oraclegs
