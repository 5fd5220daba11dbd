#pragma once

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Writes what a run that is stopped has so far as point_cloud.ply, with a report that says what it is: the newest
/// checkpoint, or else a draft model, the dense or the sparse points. A splat that shows more stays: one of an earlier
/// stop, or of a lower --quality until half of the new training. A run that has found no points is left as it is.
void LeaveBestSoFar(Run* run);

}  // namespace oraclegs
