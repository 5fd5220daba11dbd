#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "oraclegs/core/progress.h"

namespace oraclegs {

/// Summary of a path, by its "kind":
///   "scene"      format, views, camera models, sizes (from the files where there are no cameras), points, images that
///                are missing or unreadable; with `look` also "warnings": photos that are blurred, double, too dark,
///                ...
///   "workspace"  scene, options, metrics
///   "gaussians"  a splat file of any format: number, SH degree, bounding box, opacities
/// Throws InputError for any other path.
nlohmann::json Describe(const std::filesystem::path& path, bool look, const Listener& listener);

}  // namespace oraclegs
