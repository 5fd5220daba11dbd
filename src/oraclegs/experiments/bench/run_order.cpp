#include "oraclegs/experiments/bench/run_order.h"

#include <algorithm>

#include "oraclegs/settings/plan.h"
#include "oraclegs/stages/stage_works.h"

namespace oraclegs {
namespace {

template <class Group>
size_t FirstOf(const std::vector<size_t>& runs, size_t otherwise, const Group& is_in) {
  const auto first = std::find_if(runs.begin(), runs.end(), is_in);
  return first == runs.end() ? otherwise : *first;
}

}  // namespace

RunOrder::RunOrder(const BenchPlan& plan) : plan_(plan) {
  for (const BenchRun& run : plan.runs) {
    const RunOptions options = OptionsOf(run.arguments);
    needs_.push_back({oraclegs::NeedsDepth(options), HasProposals(options) && !AreProposalsSeeded(options)});
  }
}

bool RunOrder::SharesGeometry(size_t a, size_t b) const {
  return plan_.runs[a].check == plan_.runs[b].check && plan_.runs[a].seed == plan_.runs[b].seed;
}

bool RunOrder::SharesProposals(size_t a, size_t b) const {
  const BenchRun &one = plan_.runs[a], &other = plan_.runs[b];
  return one.check == other.check && one.method == other.method && needs_[a].common_proposals;
}

std::vector<size_t> RunOrder::Ready(const std::vector<size_t>& pending, const std::vector<size_t>& tried,
                                    const FoundResults& found) const {
  std::vector<size_t> ready;
  for (const size_t r : pending) {
    const auto shares = [&](size_t other) { return SharesGeometry(r, other); };
    const auto makes_depth = [&](size_t other) { return shares(other) && NeedsDepth(other); };
    const auto proposes = [&](size_t other) { return SharesProposals(r, other); };
    const auto was_tried = [&](const auto& group) { return std::any_of(tried.begin(), tried.end(), group); };
    const bool leads = FirstOf(pending, FirstOf(pending, r, shares), makes_depth) == r;
    const bool proposes_first = FirstOf(pending, r, proposes) == r;
    if ((leads || was_tried(shares) || found.geometry(r)) &&
        (proposes_first || was_tried(proposes) || found.proposals(r))) {
      ready.push_back(r);
    }
  }
  return ready;
}

}  // namespace oraclegs
