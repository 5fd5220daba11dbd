#pragma once
// The part of stage "depth" that asks a network.

#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/depth/monocular.h"
#include "oraclegs/pipeline/settings/weights.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// What Depth Anything V2 guesses of each photograph, at its size, computed on `device`. Tells StepDone{"depth"}.
/// Throws InputError for a file that does not hold it, Interrupted.
std::vector<RelativeDepth> GuessDepth(const std::filesystem::path& weights, const std::vector<LoadedView>& photos,
                                      const Listener& listener, torch::Device device = torch::kCPU);

/// "Depth Anything V2 small", "base", "large", or "of another size". Throws InputError.
std::string DepthNetworkName(const std::filesystem::path& weights);

/// By that name: "small" is Apache-2.0, "base" and "large" are CC-BY-NC-4.0 (docs/models.md).
bool IsNonCommercialDepthNetwork(const std::string& name);

struct MonocularMaps {
  std::vector<DepthMap> maps;
  double right = 0;  ///< mean over the photographs of the share that was right (depth/monocular.h)
};

/// Maps as DepthPrior::kMonocular or kFused asks. `stereo` are the photographs' maps, for kMonocular empty; `points`
/// have indices of photographs as views. Where too few points were seen, stereo aligns the network's guess. Warns of
/// photographs whose guess fits neither, which keep stereo's depth, or have none.
MonocularMaps WithMonocularDepth(const std::vector<RelativeDepth>& guesses, const std::vector<LoadedView>& photos,
                                 std::vector<DepthMap> stereo, const std::vector<ScenePoint>& points,
                                 const Listener& listener);

}  // namespace oraclegs
