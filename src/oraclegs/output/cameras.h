#pragma once
// Cameras of a run as a dataset for other trainers.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/frame.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/scene/split.h"

namespace oraclegs {

/// Content of a dataset.
struct CameraDataset {
  const Scene& scene;  ///< must have poses
  const Split& split;  ///< train and test views are written, all others left out
  ImageOptions image;  ///< decides the size of the images
  std::vector<ScenePoint> points;
  SceneFrame frame = {};  ///< frame of the scene and the points
};

struct CameraDatasetResult {
  int images = 0;
  size_t points = 0;
};

/// Names of the images in a dataset: the views' own, without the folder that contains all of them, with "_" for other
/// folders and for characters that COLMAP's text format or a shell misreads, ending in .jpg, made unique by a number.
/// In the order of `names`.
std::vector<std::string> DatasetNames(const std::vector<std::string>& names);

/// Writes to `out`, which must be missing or empty and outside the scene:
///   images/NAME.jpg       undistorted, at working size, JPEG 95
///   masks/NAME.jpg.png    for views with a mask: 255 = use
///   sparse/0/*.txt        COLMAP's model: PINHOLE cameras, poses, points with tracks
///   sparse_pc.ply         the points, as Nerfstudio's splatfacto reads them; absent without points
///   transforms.json       the cameras with OpenGL's axes (Nerfstudio, instant-ngp)
///   split.json            names of the training and test views
/// Coordinates are those of the run's point_cloud.ply; applied_transform of transforms.json is the transform between
/// them and the scene's own. The folder appears when it is complete. Throws InputError naming the fault, RunError when
/// writing fails, Interrupted.
CameraDatasetResult WriteCameraDataset(const CameraDataset& dataset, const std::filesystem::path& out,
                                       const Listener& listener);

}  // namespace oraclegs
