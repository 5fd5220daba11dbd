#pragma once
// The oracle of generators that cannot hold a view out, so that nothing is known of their errors: a folder, SEVA. It
// learns from tampered pictures what disagreement with the images means (docs/method.md#untaught-generators).

#include <cstdint>
#include <optional>
#include <vector>

#include "oraclegs/stages/proposers.h"
#include "oraclegs/stages/stage.h"
#include "oraclegs/validate/consistency.h"
#include "oraclegs/validate/picture_check.h"

namespace oraclegs {

/// Training views with what the run's own proposers show at their poses.
struct HeldOutCandidates {
  const std::vector<LoadedView>& views;
  /// Of each view, made without it.
  std::vector<std::vector<Proposal>> candidates;
};

class UntaughtOracle {
 public:
  /// How many proposals it learns from, of so many views.
  static size_t Lessons(size_t views);

  /// Learns from tampered versions of held-out views, evenly picked where there are many. The views and `proposers`
  /// must outlive it. Throws InputError when none of their pixels counts.
  UntaughtOracle(const FeatureSource& features, const Proposers& proposers, const HeldOutCandidates& held_out,
                 const Run& run);

  /// Of each; 0 everywhere for one that does not show the scene from its pose.
  std::vector<ConfidenceMap> Predict(const std::vector<Proposal>& proposals) const;

 private:
  void Teach(const HeldOutCandidates& held_out, uint64_t seed);

  FeatureSource features_;
  const Proposers& proposers_;
  ConsistencyOracle oracle_;
  PictureCheck check_;
};

}  // namespace oraclegs
