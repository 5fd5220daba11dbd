#pragma once

#include <cstdint>
#include <vector>

#include "oraclegs/core/rng.h"

namespace oraclegs {

/// A kind of training image: photos are certain, proposals are weighted by confidence.
enum class ViewKind { kPhoto, kProposal };

struct SampledView {
  ViewKind kind;
  int index;  ///< within its kind
};

/// Draws training views (docs/method.md#view-sampling): one number decides the kind, then a view leaves that kind's
/// stack at random; an empty stack is refilled. Its state is the two stacks and the random counter.
class ViewSampler {
 public:
  ViewSampler(uint64_t seed, int photos, int proposals);

  /// p_synthetic: probability of a proposal; ignored when there are none.
  SampledView Next(double p_synthetic);

  struct State {
    std::vector<int64_t> photos, proposals;
    uint64_t counter = 0;
    int64_t num_photos = 0, num_proposals = 0;  ///< needed beside the stacks, which shrink as views are drawn
  };
  State state() const;
  /// Restores the state. Throws InputError when it is of another number of views.
  void Restore(const State& state);

 private:
  uint64_t seed_;
  int num_photos_, num_proposals_;
  std::vector<int64_t> photos_, proposals_;
  Rng rng_;
};

}  // namespace oraclegs
