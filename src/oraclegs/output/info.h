#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "oraclegs/core/progress.h"

namespace oraclegs {

/// A summary of what a path is, by its "kind":
///   "scene"      format, views, camera models, sizes (of photos that came without cameras, the files'), points,
///   missing
///                and unreadable images
///   "workspace"  scene, options, metrics
///   "gaussians"  a splat file of any format: number, SH degree, bounding box, opacities
/// Throws InputError when it is none of them.
nlohmann::json Describe(const std::filesystem::path& path, const Listener& listener);

}  // namespace oraclegs
