#pragma once
// COLMAP's sparse model on disk: cameras, images and points3D as .bin or .txt, in the layout of COLMAP 3.8 (newer
// versions write the same three files).

#include <filesystem>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/colmap_model.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// True when `dir` holds the cameras and images of a model, as .bin or .txt.
bool IsColmapModel(const std::filesystem::path& dir);

/// One part of a model alone; no points when it has no points3D file. Throws InputError as ReadColmapScene does.
ColmapCameras ReadColmapCameras(const std::filesystem::path& model_dir);
std::vector<ColmapImage> ReadColmapImages(const std::filesystem::path& model_dir);
std::vector<ColmapPoint> ReadColmapPoints(const std::filesystem::path& model_dir);

/// A whole model as a scene: root = model_dir, views (as_stored) sorted by name with images looked up below image_dir,
/// points with the views that saw them. Warns of views without an image file and of points that are dropped (not
/// finite, or seen by no view). Throws InputError naming the file: missing, truncated, a camera id or model that
/// is unknown, bad intrinsics, a pose that is not one, two images of one name, no image file at all.
/// `allow_outside`: as of SceneReadOptions.
Scene ReadColmapScene(const std::filesystem::path& model_dir, const std::filesystem::path& image_dir,
                      const Listener& listener, bool allow_outside = false);

}  // namespace oraclegs
