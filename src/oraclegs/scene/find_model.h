#pragma once
// Where the COLMAP model of a scene folder is.

#include <filesystem>
#include <optional>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

struct ModelPlace {
  std::filesystem::path model;   ///< the folder with cameras and images
  std::filesystem::path images;  ///< the folder that its images' names start from
};

/// The model in sparse/N, sparse/ or the folder itself. Several sparse/N are pieces that COLMAP could not join: the one
/// with the most images is taken, with a note. `options.images` names the images' folder; else it is images/, or
/// the scene's folder where only that has them.
std::optional<ModelPlace> FindModel(const std::filesystem::path& root, const SceneReadOptions& options,
                                    const Listener& listener);

/// The one model in other folders below (colmap/sparse/0, dense/sparse, ...) that fits photos of the scene: half of its
/// images are there, in sizes that its cameras can have, and they are half of what the scene has of photos. A note says
/// that it is used. Models that do not fit, several that do, and a transforms.json or transforms_train.json in a folder
/// below are named in warnings and not used.
std::optional<ModelPlace> FindModelBeside(const std::filesystem::path& root, const SceneReadOptions& options,
                                          const Listener& listener);

}  // namespace oraclegs
