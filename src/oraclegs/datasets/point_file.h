#pragma once

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Reads scene->point_file, where there is one, to the scene's points; those that fall into no view are left out, with
/// a warning. Throws InputError naming the file.
void ReadPointFile(const Listener& listener, Scene* scene);

}  // namespace oraclegs
