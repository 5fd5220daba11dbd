#pragma once
// The oracle of a run, which knows candidates and what is mixed from them.

#include <memory>
#include <vector>

#include "oraclegs/pipeline/settings/oracle_choice.h"
#include "oraclegs/pipeline/stages/proposers.h"
#include "oraclegs/validate/consistency.h"
#include "oraclegs/validate/pick.h"

namespace oraclegs {

/// Learns from hidden photographs when it is made (but "uniform", and "vggt" without --calibrate). `photos` and
/// `proposers` must outlive it.
class Judge {
 public:
  /// targets: how many are going to be asked about, for the progress of "validate". Throws InputError for weights that
  /// do not fit, RunError when VGGT needs more memory than there is.
  Judge(const Run& run, const std::vector<LoadedView>& photos, const Proposers& proposers, const OracleChoice& choice,
        size_t targets);

  /// How many targets are best asked about in one call.
  size_t together() const { return together_; }
  /// True when passes of VGGT are what the time goes to; they are told as they are done.
  bool tells_progress() const { return second_ != nullptr; }

  /// One picture of each target that has candidates, in their order.
  std::vector<Validated> operator()(std::vector<std::vector<Proposal>> candidates) const;

 private:
  const Oracle& oracle() const;
  void LoadSecond(const Run& run, const std::vector<LoadedView>& photos, const VggtWeights& weights);
  void Teach(const std::vector<LoadedView>& photos, const Proposers& proposers, size_t targets);

  PickRule rule_;
  size_t together_;
  struct Progress;
  std::shared_ptr<Progress> progress_;             ///< of second_
  std::unique_ptr<Oracle> second_;                 ///< VGGT before calibration, null without
  std::unique_ptr<ConsistencyOracle> calibrated_;  ///< null where VGGT's maps count as they are
  std::unique_ptr<Oracle> uniform_;
};

}  // namespace oraclegs
