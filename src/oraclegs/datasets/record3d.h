#pragma once
// A capture of Record3D, unpacked from its .r3d file (a zip archive) or exported as EXR + JPG: metadata.json (metadata
// in a .r3d) with "K" (3 x 3, column by column), "w", "h" and "poses", [qx, qy, qz, qw, x, y, z] from the camera
// (right, up, backwards) to the world in meters; the image of pose N is rgbd/N.jpg, or rgb/N.jpg.

#include <filesystem>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// True for a folder with such a file and images.
bool IsRecord3dScene(const std::filesystem::path& root);

/// Reads poses and images. Depth, which Record3D packs by LZFSE or writes as EXR, is not read, which a note says.
/// Images without a pose are left out, with a warning. Throws InputError naming the file.
Scene ReadRecord3dScene(const std::filesystem::path& root, const SceneReadOptions& options, const Listener& listener);

}  // namespace oraclegs
