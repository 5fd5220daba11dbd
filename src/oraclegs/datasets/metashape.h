#pragma once
// Metashape's cameras as XML (File > Export > Export Cameras): sensors with their calibration, cameras with a 4x4
// matrix from the camera (x right, y down, z forward) to the chunk, and the chunk's or a component's own place in the
// world.

#include <filesystem>
#include <string>
#include <string_view>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// True for a folder with such a file.
bool IsMetashapeScene(const std::filesystem::path& root);

/// Reads cameras.xml, or the first such file, with the photos that its labels name, also without extension. Cameras
/// without a pose are left out, with a warning; disabled ones without. Throws InputError naming the file and the
/// camera: bad XML, a sensor without calibration, a panorama, a matrix that is no pose.
Scene ReadMetashapeScene(const std::filesystem::path& root, const SceneReadOptions& options, const Listener& listener);

}  // namespace oraclegs
