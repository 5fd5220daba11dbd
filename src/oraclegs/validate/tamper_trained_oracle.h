#pragma once
// The oracle of generators that cannot hold a view out, a folder or SEVA, whose errors are not known: it learns from
// tampered pictures what disagreement with the images means (docs/method.md#tamper-trained-oracle).

#include <cstdint>
#include <optional>
#include <vector>

#include "oraclegs/propose/proposers.h"
#include "oraclegs/scene/loaded_view.h"
#include "oraclegs/validate/consistency.h"
#include "oraclegs/validate/picture_check.h"

namespace oraclegs {

/// Indices of the views that an oracle learns from, of so many: evenly picked, at most 24, beyond which it learns no
/// more and works longer.
std::vector<size_t> LearnedViews(size_t views);

/// Training views and the candidates at their poses.
struct HeldOutCandidates {
  const std::vector<LoadedView>& views;
  std::vector<std::vector<Proposal>>
      candidates;  ///< for each view, made without it; none for those not in LearnedViews
};

class TamperTrainedOracle {
 public:
  /// Number of proposals it learns from, of so many views.
  static size_t TrainingSamples(size_t views);

  /// Learns from tampered versions of held-out views, evenly picked where there are many. The views and `proposers`
  /// must outlive it. Throws InputError when none of their pixels counts.
  TamperTrainedOracle(const FeatureSource& features, const Proposers& proposers, const HeldOutCandidates& held_out,
                      LevelRule rule, uint64_t seed);

  /// Confidence of each proposal; 0 everywhere for one that does not show the scene from its pose.
  std::vector<ConfidenceMap> Predict(const std::vector<Proposal>& proposals) const;

 private:
  void Learn(const HeldOutCandidates& held_out, uint64_t seed);

  FeatureSource features_;
  const Proposers& proposers_;
  ConsistencyOracle oracle_;
  PictureCheck check_;
};

}  // namespace oraclegs
