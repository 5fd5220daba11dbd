#pragma once
// Where the depth of pseudo views comes from in a run (baselines/baseline_setup.h): a network where there is one, else
// stereo.

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "oraclegs/baselines/baseline_setup.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/depth/depth_map.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Depth that Depth Anything V2 sees in the render itself, as FSGS has it: the render is moved, too. Networks compute
/// on `device`, or, with a warning, on the CPU where libtorch has no CUDA. Throws InputError for a file that is none.
PseudoDepth NetworkPseudoDepth(const std::filesystem::path& weights, Device device, const Listener& listener);

/// Stereo's depth of the views, seen from there (propose/warp.h): stands in for a network's. Counts where a depth
/// map shows a surface, or nothing beside an object; without any depth it counts nowhere. Throws ShapeError as Warper.
PseudoDepth StereoPseudoDepth(std::vector<LoadedView> views, std::vector<DepthMap> maps);

}  // namespace oraclegs
