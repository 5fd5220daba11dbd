#pragma once
// LLFF's poses_bounds.npy: a row for each image in the order of their names. A row is a 3x5 matrix row by row, camera
// to world with the axes down, right and backwards, then height, width and focal length in pixels, then two depths.

#include <filesystem>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// True for a folder with poses_bounds.npy.
bool IsLlffScene(const std::filesystem::path& root);

/// Reads root/poses_bounds.npy with the images of images/, else of images_N/ with the smallest N (DatasetImageFolder).
/// Intrinsics are of the size that the file names. Throws InputError naming the file, and the row.
Scene ReadLlffScene(const std::filesystem::path& root, const SceneReadOptions& options, const Listener& listener);

}  // namespace oraclegs
