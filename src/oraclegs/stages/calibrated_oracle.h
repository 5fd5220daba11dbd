#pragma once
// The oracle of a run: calibrated on held-out views, for candidates and for what is mixed from them.

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "oraclegs/stages/proposers.h"
#include "oraclegs/stages/stage.h"
#include "oraclegs/stages/untaught_oracle.h"
#include "oraclegs/validate/consistency.h"
#include "oraclegs/validate/pick.h"

namespace oraclegs {

/// How many proposals VGGT looks at together: `asked`; or the most whose pass needs no more than the free memory, up to
/// 8 where that is automatic, up to `all` where 0 is asked for. bytes(n): what a pass over n proposals needs with the
/// weights; available: bytes, 0 = unknown. Warns of a chunk that was made smaller, or that was asked for and may not
/// fit. Throws RunError when not even one fits and no number was asked for.
size_t ChooseChunk(const std::function<int64_t(int64_t)>& bytes, const Auto<int>& asked, size_t all, uint64_t available,
                   const Listener& listener);

class CalibratedOracle {
 public:
  /// Learns from held-out views (but "uniform", and "vggt" without --calibrate). `training` and `proposers` must
  /// outlive it. targets: how many are going to be classified, for the progress of "validate". Throws InputError for
  /// weights that do not fit, RunError when VGGT needs more memory than there is.
  CalibratedOracle(const Run& run, const TrainingViews& training, const Proposers& proposers, size_t targets);
  ~CalibratedOracle();

  /// How many targets are best classified in one call.
  size_t together() const { return together_; }
  /// True when passes of VGGT are what the time goes to; they are reported as they are done.
  bool reports_progress() const { return second_ != nullptr; }

  /// Of each target that has candidates, in their order: one image of the candidates, with its confidence. Candidates
  /// that do not show the scene from their pose are left out where there are others.
  std::vector<Validated> Classify(std::vector<std::vector<Proposal>> candidates) const;

 private:
  struct Progress;

  const Oracle& oracle() const;
  void LoadSecond(const Run& run, const std::vector<LoadedView>& views, const VggtWeights& weights, size_t targets);
  void Calibrate(const HeldOutCandidates& held_out);
  /// Of each, from the oracle of untaught generators where `untaught`.
  std::vector<ConfidenceMap> Predict(const std::vector<Proposal>& proposals, const std::vector<bool>& untaught) const;

  PickRule rule_;
  size_t together_;
  std::shared_ptr<Progress> progress_;             ///< of second_
  std::unique_ptr<Oracle> second_;                 ///< VGGT before calibration, null without
  std::unique_ptr<ConsistencyOracle> calibrated_;  ///< null where VGGT's maps are used as they are
  std::unique_ptr<Oracle> uniform_;
  std::unique_ptr<UntaughtOracle> untaught_;  ///< null without generators that cannot hold a view out
  std::set<std::string> taught_;              ///< sources that can
};

}  // namespace oraclegs
