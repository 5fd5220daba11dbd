#pragma once

#include <filesystem>

#include "oraclegs/sfm/colmap_runner.h"

namespace oraclegs {

/// Points of the database's matches at the poses and cameras of the model in `poses`, as a model in `made`, which must
/// be there. Points that only two images saw stay: there are few images. Options in `more` come first. Throws
/// ColmapFailure.
void TriangulateAtPoses(const ColmapRunner& colmap, const std::filesystem::path& poses,
                        const std::filesystem::path& made, const ColmapOptions& more = {});

}  // namespace oraclegs
