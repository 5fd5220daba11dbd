#pragma once
// The part of stage "depth" that a network contributes.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/buffer.h"
#include "oraclegs/core/progress.h"
#include "oraclegs/depth/monocular.h"
#include "oraclegs/depth/silhouettes.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Depth Anything V2's prediction for each view, at its size, computed on `device`. Reports StepDone{"depth"}. Throws
/// InputError for a file that does not hold it, UsageError as GetNetworks does, Interrupted.
std::vector<RelativeDepth> PredictRelativeDepth(const std::filesystem::path& weights,
                                                const std::vector<LoadedView>& views, const Listener& listener,
                                                Device device = kCpu);

/// By DepthNetworkName: "small" is Apache-2.0, "base" and "large" are CC-BY-NC-4.0 (docs/models.md).
bool IsNonCommercialDepthNetwork(const std::string& name);

struct MonocularMaps {
  std::vector<DepthMap> maps;
  double right = 0;  ///< mean over the views of the share that was right (depth/monocular.h)
};

/// The network's prediction for each view.
struct NetworkDepth {
  const std::vector<RelativeDepth>& predicted;
  bool is_whole = false;  ///< kMonocular: taken whole (WholeDepth), as the paper's depth loss does
};

/// Maps as DepthPrior::kMonocular or kFused asks. `stereo` are the views' maps, for kMonocular empty; `points` have
/// indices into `views`. Where too few points were seen, the network's depth is aligned to stereo. Warns of views whose
/// network depth fits neither, which keep stereo's depth, or have none.
MonocularMaps WithMonocularDepth(const NetworkDepth& network, const std::vector<LoadedView>& views,
                                 std::vector<DepthMap> stereo, const std::vector<ScenePoint>& points,
                                 const Listener& listener);

}  // namespace oraclegs
