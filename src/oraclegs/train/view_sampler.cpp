#include "oraclegs/train/view_sampler.h"

#include <numeric>
#include <set>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

void CheckStack(const char* kind, const std::vector<int64_t>& stack, int views) {
  std::set<int64_t> seen;
  for (const int64_t view : stack) {
    if (view < 0 || view >= views || !seen.insert(view).second) {
      throw InputError("the saved stack of {} holds view {}, which does not fit {} views", kind, view, views);
    }
  }
}

}  // namespace

ViewSampler::ViewSampler(uint64_t seed, int photographs, int proposals)
    : seed_(seed), num_photographs_(photographs), num_proposals_(proposals), rng_(seed, RandomStream::kViewOrder) {
  if (photographs < 0 || proposals < 0 || photographs + proposals == 0) {
    throw ShapeError("ViewSampler: {} photographs and {} proposals, needs at least one view", photographs, proposals);
  }
}

SampledView ViewSampler::Next(double p_synthetic) {
  // The number is drawn even when it cannot matter, so that the order of photographs does not depend on the proposals'
  // being there.
  const bool wants_proposal = rng_.Uniform() < p_synthetic;
  const bool proposal = num_photographs_ == 0 || (wants_proposal && num_proposals_ > 0);
  std::vector<int64_t>& stack = proposal ? proposals_ : photographs_;
  if (stack.empty()) {
    stack.resize(proposal ? num_proposals_ : num_photographs_);
    std::iota(stack.begin(), stack.end(), 0);
  }
  const auto pick = stack.begin() + rng_.Index(static_cast<int64_t>(stack.size()));
  const SampledView view{proposal ? ViewKind::kProposal : ViewKind::kPhotograph, static_cast<int>(*pick)};
  stack.erase(pick);
  return view;
}

ViewSampler::State ViewSampler::state() const {
  return {photographs_, proposals_, rng_.counter(), num_photographs_, num_proposals_};
}

void ViewSampler::Restore(const State& state) {
  if (state.num_photographs != num_photographs_ || state.num_proposals != num_proposals_) {
    throw InputError("the checkpoint is of {} photographs and {} proposals, this run has {} and {}; start anew",
                     state.num_photographs, state.num_proposals, num_photographs_, num_proposals_);
  }
  CheckStack("photographs", state.photographs, num_photographs_);
  CheckStack("proposals", state.proposals, num_proposals_);
  photographs_ = state.photographs;
  proposals_ = state.proposals;
  rng_ = Rng(seed_, RandomStream::kViewOrder, state.counter);
}

}  // namespace oraclegs
