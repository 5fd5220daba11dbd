#pragma once
// Cameras and a first cloud from VGGT, in one pass over all photographs (spec/vggt.md 9 to 11).

#include <filesystem>

#include "oraclegs/core/progress.h"
#include "oraclegs/pipeline/settings/vggt_weights.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// What RegisterPhotos (scene/sfm.h) does, by VGGT in place of colmap: every photograph gets a pinhole camera, and
/// points are where depth maps of at least two photographs agree. Owns work_dir and writes the same files there:
/// sparse/0 (as text), images/, masks/, inputs.json; a finished model of the same photographs and weights is read
/// instead of made again. The network runs on `device`; scale and orientation of the world are its own. Throws
/// InputError for fewer than two photographs, a photograph without a camera, or weights that do not fit; RunError when
/// the photographs need more memory than is free.
Scene RegisterWithVggt(const Scene& photos, const VggtWeights& weights, const std::filesystem::path& work_dir,
                       const Listener& listener, torch::Device device = torch::kCPU);

/// Throws RunError when `needed` bytes for `views` photographs are more than `available`; 0 = nobody knows.
void RequirePoseMemory(size_t views, int64_t needed, uint64_t available);

}  // namespace oraclegs
