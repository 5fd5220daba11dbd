#pragma once

#include <filesystem>
#include <vector>

#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Writes positions and colors as an ascii PLY, as Nerfstudio and every viewer of point clouds read it, atomically.
/// Throws RunError.
void WritePointPly(const std::filesystem::path& path, const std::vector<ScenePoint>& points);

}  // namespace oraclegs
