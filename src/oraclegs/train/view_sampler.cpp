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

ViewSampler::ViewSampler(uint64_t seed, int photos, int proposals)
    : seed_(seed), num_photos_(photos), num_proposals_(proposals), rng_(seed, RandomStream::kViewOrder) {
  if (photos < 0 || proposals < 0 || photos + proposals == 0) {
    throw ShapeError("ViewSampler: {} photos and {} proposals, needs at least one view", photos, proposals);
  }
}

SampledView ViewSampler::Next(double p_synthetic) {
  // The number is drawn even when it cannot matter, so that the order of photos does not depend on the presence of
  // proposals.
  const bool wants_proposal = rng_.Uniform() < p_synthetic;
  const bool proposal = num_photos_ == 0 || (wants_proposal && num_proposals_ > 0);
  std::vector<int64_t>& stack = proposal ? proposals_ : photos_;
  if (stack.empty()) {
    stack.resize(proposal ? num_proposals_ : num_photos_);
    std::iota(stack.begin(), stack.end(), 0);
  }
  const auto pick = stack.begin() + rng_.Index(static_cast<int64_t>(stack.size()));
  const SampledView view{proposal ? ViewKind::kProposal : ViewKind::kPhoto, static_cast<int>(*pick)};
  stack.erase(pick);
  return view;
}

ViewSampler::State ViewSampler::state() const {
  return {photos_, proposals_, rng_.counter(), num_photos_, num_proposals_};
}

void ViewSampler::Restore(const State& state) {
  if (state.num_photos != num_photos_ || state.num_proposals != num_proposals_) {
    throw InputError("the checkpoint is of {} photos and {} proposals, this run has {} and {}; start anew",
                     state.num_photos, state.num_proposals, num_photos_, num_proposals_);
  }
  CheckStack("photos", state.photos, num_photos_);
  CheckStack("proposals", state.proposals, num_proposals_);
  photos_ = state.photos;
  proposals_ = state.proposals;
  rng_ = Rng(seed_, RandomStream::kViewOrder, state.counter);
}

}  // namespace oraclegs
