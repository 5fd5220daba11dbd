#pragma once
// Polycam's raw export: a JSON with camera and pose (right, up, backwards; meters, y up) for each image of the same
// name. corrected_cameras/ with corrected_images/ are those that Polycam has adjusted, cameras/ with images/ those of
// the phone; both lie in keyframes/ or in the folder itself.

#include <filesystem>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// True for a folder with such images and cameras. One that only has cameras/ and images/ needs a confidence/, too.
bool IsPolycamScene(const std::filesystem::path& root);

/// Reads the corrected cameras, else those of the phone. Images without a JSON are left out, with a warning. Throws
/// InputError naming the file.
Scene ReadPolycamScene(const std::filesystem::path& root, const SceneReadOptions& options, const Listener& listener);

}  // namespace oraclegs
