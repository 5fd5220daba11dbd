#pragma once
// What is known of a scene before any pixel is read: photographs, lenses, poses, points. Torch-free.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/camera/intrinsics.h"

namespace oraclegs {

enum class SceneFormat { kColmap, kTransforms, kBlender, kPhotos };

/// Which file of a Blender-style scene a view came from; kNone elsewhere.
enum class DeclaredRole { kNone, kTrain, kVal, kTest };

/// One photograph with its lens and, unless the scene is a plain folder, its pose.
struct SceneView {
  std::string name;                  ///< unique; the image's path below the image folder, e.g. "0001.jpg"
  std::filesystem::path image_path;  ///< exists
  std::filesystem::path mask_path;   ///< empty when there is none; white = use, black = ignore
  Intrinsics lens;                         ///< of the full-size photograph; params empty for a plain folder
  std::optional<Eigen::Isometry3d> cam_from_world;
  bool as_stored = false;  ///< lens and pose describe the pixels as stored: the EXIF orientation does not count
  DeclaredRole role = DeclaredRole::kNone;
};

struct ScenePoint {
  Eigen::Vector3d xyz;
  std::array<uint8_t, 3> rgb{128, 128, 128};
  std::vector<int> views;  ///< indices into Scene::views of the photographs that saw it, ascending
};

/// A scene as read, views sorted by name.
struct Scene {
  std::filesystem::path root;
  SceneFormat format = SceneFormat::kPhotos;
  std::vector<SceneView> views;
  std::vector<ScenePoint> points;
  std::vector<std::string> missing_images;  ///< posed in the scene's files, but without an image file; left out

  bool HasPoses() const { return format != SceneFormat::kPhotos; }
};

struct SceneReadOptions {
  std::filesystem::path images;  ///< image folder, empty = where the format usually has it
};

/// Recognises and reads a scene folder:
///   sparse/0 or sparse (cameras, images, points3D as .bin or .txt) with images/  -> kColmap
///   transforms.json                                                              -> kTransforms
///   transforms_train.json and transforms_test.json (transforms_val.json is optional) -> kBlender
///   a folder of .jpg and .png (or one with images/)                               -> kPhotos
/// Views whose image file is missing go to missing_images and are told to `listener`. Throws InputError naming the file
/// and the mend: nothing recognised, no image found, a truncated file, a pose that is not finite or not a rotation, a
/// focal length that is not positive, two views of one name, a name that is not UTF-8.
Scene ReadScene(const std::filesystem::path& root, const SceneReadOptions& options, const Listener& listener);

}  // namespace oraclegs
