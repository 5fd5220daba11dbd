#pragma once

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Stage "sfm": sparse points of the training views, with indices of run->scene. A COLMAP model's points count when the
/// training views saw them; otherwise, or when they are too few, points are triangulated from the training views
/// (cached in sfm/). Not wanted where no other stage would use them.
StageWork SfmStage();

}  // namespace oraclegs
