#pragma once

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Fewer points than this are joined by a network's, where there is one.
inline constexpr size_t kMinDensePoints = 1000;

/// Stage "depth": multi-view stereo over the training views, in the order of the split, and what Depth Anything V2
/// predicts of each (--depth-prior). Writes depth/ and sfm/dense.ply. Reports what share of the pixels is confident,
/// how often the network was right, or what brings its weights where it is missed; warns of views of which next to
/// nothing is known. Throws InputError for weights that are damaged.
StageWork DepthStage();

/// For a command that wants nothing but depth: the stage is wanted, whatever the options need. Throws UsageError for
/// --depth-prior none.
void RequireDepth(Run* run);

}  // namespace oraclegs
