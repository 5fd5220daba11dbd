#pragma once
// The proposers of a run with what they work from, and their candidates.

#include <memory>
#include <optional>
#include <vector>

#include "oraclegs/propose/stored_proposer.h"
#include "oraclegs/propose/warp.h"
#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Owns the proposers that --proposers names, and where none can be asked "warp".
class Proposers {
 public:
  /// The training views and the geometry must outlive it.
  Proposers(const Run& run, const TrainingViews& training, const Geometry& geometry, std::vector<ProxyModel> proxies);

  const Warper& warper() const { return *warper_; }
  /// Candidates of each target, in their order. held_out: of each target, the training view that no evidence may come
  /// from; empty = none of any. A target that no proposer answers has none.
  std::vector<std::vector<Proposal>> Ask(const std::vector<Target>& targets,
                                         const std::vector<std::optional<int>>& held_out = {}) const;

  /// Whether proxy models can say what a view shows.
  bool has_proxy_models() const { return splat_ != nullptr; }
  /// What they show at a new pose; nothing without them.
  std::optional<Proposal> ProxyRender(const Target& target) const;

 private:
  std::unique_ptr<Warper> warper_;
  std::unique_ptr<Proposer> warp_, splat_;  ///< null when not asked for
  bool warp_paints_ = true;                 ///< false: asked for held-out views alone, so that the oracle learns
  std::vector<StoredProposer> stored_;      ///< one for each folder of images that were made for all targets at once
};

/// Those of the run's results, made when they are first asked for; they take its proxy models.
const Proposers& ProposersOf(Run* run);

}  // namespace oraclegs
