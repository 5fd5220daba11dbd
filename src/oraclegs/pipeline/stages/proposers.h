#pragma once
// The proposers of a run with what they work from, and their answers.

#include <memory>
#include <vector>

#include "oraclegs/pipeline/stages/depth_stage.h"
#include "oraclegs/pipeline/stages/seva_stage.h"
#include "oraclegs/propose/ensemble.h"
#include "oraclegs/propose/warp.h"

namespace oraclegs {

/// Owns the proposers that --proposers names, and where none can be asked "warp"; `photos` and `geometry` must outlive
/// it.
class Proposers {
 public:
  Proposers(const Run& run, const std::vector<LoadedView>& photos, const Geometry& geometry, std::vector<ProxyModel> opinions);

  const Warper& warper() const { return *warper_; }
  /// Candidates of each target, in their order, hidden photograph by hidden photograph (-1 = none hidden; one for each
  /// target). A target that no proposer answers has none.
  std::vector<std::vector<Proposal>> Ask(const std::vector<Target>& targets, const std::vector<int>& hidden) const;

 private:
  Silhouettes silhouettes_;
  std::unique_ptr<Warper> warper_;
  std::unique_ptr<Proposer> warp_, splat_;  ///< null when not asked for
  bool warp_paints_ = true;                 ///< false: asked for hidden photographs alone, so that the oracle learns
  std::vector<SevaProposer> seva_;          ///< one for each of its candidates
};

}  // namespace oraclegs
