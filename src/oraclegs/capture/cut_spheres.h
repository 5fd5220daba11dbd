#pragma once
// Writes the views that spherical and wide fisheye photos are cut into.

#include <filesystem>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Writes images and masks of the scene's views that are faces (scene/spheres.h: TakeFaces with this `dir`), and
/// dir/faces.json: which photos they were cut from, and how each is turned. Does nothing where `dir` has them of
/// the same photos and masks. `dir` appears when it is whole; its parent must be there. Reports the stage "import".
/// Throws InputError naming a photo or mask that cannot be read, RunError when `dir` cannot be written.
void CutSpheres(const Scene& scene, const std::filesystem::path& dir, const Listener& listener);

}  // namespace oraclegs
