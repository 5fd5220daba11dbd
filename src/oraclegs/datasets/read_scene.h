#pragma once
// Scene folders of any supported format.

#include <filesystem>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Recognizes and reads a scene folder:
///   sparse/0 or sparse (cameras, images, points3D as .bin or .txt) with images/  -> kColmap
///   transforms.json                                                              -> kTransforms
///   transforms_train.json and transforms_test.json (transforms_val.json is optional) -> kBlender
///   a model in another folder below that fits the photos (see find_model.h)      -> kColmap
///   photos below the folder (or below its images/)                                -> kPhotos (see photo_folder.h)
/// Spherical photos become six views each where options.faces says where these are to lie (scene/spheres.h).
/// Views whose image file is missing go to missing_images and are reported to `listener`. Throws InputError naming the
/// file and how to fix it: nothing recognized, no image found, a truncated file, a pose that is not finite or not a
/// rotation, a focal length that is not positive, two views of one name, a name that is not UTF-8, an image or mask
/// outside the folder (SceneReadOptions).
Scene ReadScene(const std::filesystem::path& folder, const SceneReadOptions& options, const Listener& listener);

}  // namespace oraclegs
