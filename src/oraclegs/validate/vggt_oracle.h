#pragma once
// The paper's oracle: how much the views of a scene attend to each other inside VGGT (docs/method.md#vggt-oracle).

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "oraclegs/networks/networks.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/validate/options.h"
#include "oraclegs/validate/oracle.h"

namespace oraclegs {

struct VggtOracleOptions {
  OraclePass pass = OraclePass::kChunk;
  size_t chunk = 8;   ///< kChunk: proposals in one pass, beside the reference; kAll: images in one pass
  uint64_t seed = 0;  ///< of the order of kAll
  /// Called after each pass with the number of its proposals; may be empty.
  std::function<void(size_t)> on_pass = {};
};

/// Runs a training view and a few proposals at a time (view_chunks.h), or all of both in random order, through VGGT's
/// aggregator. A map is large where the other views, or the reference, attend to the proposal. It ranks pixels, and is
/// no probability until it is calibrated (ConsistencyOracle). Proposals of one pass influence each other; those of
/// other passes do not.
class VggtOracle : public Oracle {
 public:
  /// `views` must outlive it. Throws ShapeError when the chunk is 0.
  VggtOracle(std::unique_ptr<AttentionNetwork> network, VggtOracleOptions options,
             const std::vector<LoadedView>& views);

  std::string name() const override { return "vggt"; }
  using Oracle::Predict;
  /// Throws InputError as PlanChunks does, ShapeError for a held-out view with kAll, Interrupted.
  std::vector<ConfidenceMap> Predict(const std::vector<Query>& queries) const override;

 private:
  std::vector<ConfidenceMap> PredictChunks(const std::vector<Query>& queries) const;
  std::vector<ConfidenceMap> PredictShuffled(const std::vector<Query>& queries) const;

  std::unique_ptr<AttentionNetwork> network_;
  VggtOracleOptions options_;
  const std::vector<LoadedView>& views_;
};

// --set vggt-layers and --set vggt-layer-weights: the layers of VGGT's map (docs/method.md#vggt-oracle).

/// Layers asked for with their weights, which sum to 1; empty when none are. Throws UsageError naming the option for
/// text that is no whole numbers, a layer named twice, a weight that is no number >= 0, different numbers of layers and
/// weights, and weights that are all 0 or come without layers.
std::vector<LayerWeight> AttentionLayersOf(const ValidateOptions& options);

/// Throws UsageError for a layer that `network`, with layers 0 to depth - 1, does not have.
void RequireAttentionLayers(const std::vector<LayerWeight>& layers, int64_t depth, const std::string& network);

}  // namespace oraclegs
