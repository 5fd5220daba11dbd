#pragma once
// The paper's oracle: how much the views of a scene attend to each other inside VGGT (docs/method.md#vggt-oracle).

#include <functional>
#include <memory>
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

}  // namespace oraclegs
