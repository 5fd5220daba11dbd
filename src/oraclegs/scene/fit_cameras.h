#pragma once

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

/// Scales the intrinsics of each posed view to its image where that has another size but, to a pixel, the same aspect,
/// in one of its orientations. One note says so. Views whose image cannot be read, or has another aspect, stay as they
/// are: who loads them says why not. Warns of cameras whose principal point is in the middle of an image of another
/// size. Reads headers.
void FitCamerasToImages(Scene* scene, const Listener& listener);

/// True when two images can be one in two sizes: a side is less than a pixel off what the other side asks for.
bool HaveSameAspect(int width, int height, int other_width, int other_height);

}  // namespace oraclegs
