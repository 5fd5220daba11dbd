#pragma once
// Bundler's bundle.out of version 0.3: for each photo of list.txt a focal length, two radial coefficients and a pose
// with the axes right, up and backwards; then points with the photos that saw them.

#include <filesystem>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// True for a folder with bundle.out (or bundle/bundle.out, or one that ends in .rd.out) and list.txt.
bool IsBundlerScene(const std::filesystem::path& root);

/// Reads it with the photos of list.txt, which may lie in the folder or in images/. Photos with a focal length of 0
/// were not placed and are left out, with a warning. Throws InputError naming the file and the line or the camera.
Scene ReadBundlerScene(const std::filesystem::path& root, const SceneReadOptions& options, const Listener& listener);

}  // namespace oraclegs
