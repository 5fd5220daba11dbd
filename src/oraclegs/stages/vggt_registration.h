#pragma once
// Cameras and a first cloud from VGGT, in one pass over all images (docs/method.md#vggt-cameras-and-cloud).

#include <filesystem>

#include "oraclegs/core/buffer.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/settings/vggt_weights.h"

namespace oraclegs {

/// Registers views like RegisterViews (sfm/), by VGGT in place of colmap: every image gets a pinhole camera, and points
/// are where depth maps of at least two images agree. Owns work_dir and writes the same files there: sparse/0 (as
/// text), images/, masks/, inputs.json; a finished model of the same images and weights is read instead of made again.
/// The network runs on `device`; scale and orientation of the world are its own. Throws InputError for fewer than two
/// images, an image without a camera, or weights that do not fit; RunError when the images need more memory than is
/// free; UsageError as GetNetworks does.
Scene RegisterWithVggt(const Scene& photos, const VggtWeights& weights, const std::filesystem::path& work_dir,
                       const Listener& listener, Device device = kCpu);

}  // namespace oraclegs
