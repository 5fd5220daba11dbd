#pragma once
// The order in which the runs of a benchmark start, so that those that share results need them made only once.

#include <functional>
#include <vector>

#include "oraclegs/experiments/bench/bench_plan.h"

namespace oraclegs {

/// Whether another run's workspace has results that a run may copy.
struct FoundResults {
  std::function<bool(size_t run)> geometry, proposals;
};

class RunOrder {
 public:
  explicit RunOrder(const BenchPlan& plan);

  /// True for runs of one scene, number of views and seed.
  bool SharesGeometry(size_t a, size_t b) const;
  /// True for runs of one scene, number of views and method that differ in their seed, on which proposals do not
  /// depend; also for a run and itself.
  bool SharesProposals(size_t a, size_t b) const;
  /// True where the run needs the depth of the training views.
  bool NeedsDepth(size_t run) const { return needs_[run].depth; }

  /// Runs of `pending`, which is ascending and not empty, that can start now. One of the runs that share geometry
  /// computes it, the first that needs depth or else the first, and the others wait until it was tried; so do runs for
  /// the proposals of the first of those that share them.
  std::vector<size_t> Ready(const std::vector<size_t>& pending, const std::vector<size_t>& tried,
                            const FoundResults& found) const;

 private:
  struct Needs {
    bool depth = false;
    bool common_proposals = false;  ///< has proposals that runs of other seeds have as well
  };

  const BenchPlan& plan_;
  std::vector<Needs> needs_;  ///< of each run of the plan
};

}  // namespace oraclegs
