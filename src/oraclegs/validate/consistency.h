#pragma once
// The oracle that needs no weights: what the images show at a proposal's pixels, and what such pixels turned out to be
// worth where a training view was held out and proposed (docs/method.md#consistency-oracle).

#include <string>
#include <utility>
#include <vector>

#include "oraclegs/validate/calibrator.h"
#include "oraclegs/validate/feature_source.h"
#include "oraclegs/validate/oracle.h"

namespace oraclegs {

/// Confidence = the similarity that pixels of such features had in held-out views, smoothed where it comes from the
/// images (smooth.h). Never looks at a test view. What is referenced must outlive it.
class ConsistencyOracle : public Oracle {
 public:
  ConsistencyOracle(FeatureSource features, const std::vector<LoadedView>& views, LevelRule rule = LevelRule::kFitted)
      : features_(features), views_(views), calibrator_(rule) {}

  /// Learns from proposals of held-out views; those of a source that was learned before replace it. Throws InputError
  /// when none of their pixels counts, ShapeError for one that holds no view out.
  void Calibrate(const std::vector<Query>& held_out);
  /// The same, and the confidence of what was learned from. A second oracle is asked once.
  std::vector<ConfidenceMap> CalibrateAndPredict(const std::vector<Query>& held_out);

  /// What pixels of proposals of held-out views teach, at most `limit` of each: with the names of their sources, in
  /// their order. For lessons that are not held in memory all at once. Throws ShapeError as Calibrate does.
  std::vector<std::pair<std::string, PixelSamples>> Sample(const std::vector<Query>& held_out, size_t limit) const;
  /// As Calibrate, from such samples.
  void Fit(const std::vector<std::pair<std::string, PixelSamples>>& samples) { calibrator_.Fit(samples); }

  /// That of the features.
  std::string name() const override { return features_.name(); }
  using Oracle::Predict;
  /// Throws UsageError before Calibrate.
  std::vector<ConfidenceMap> Predict(const std::vector<Query>& queries) const override;

 private:
  void Calibrate(const std::vector<Query>& held_out, const std::vector<ConfidenceMap>& second);
  std::vector<std::pair<std::string, PixelSamples>> Sample(const std::vector<Query>& held_out,
                                                           const std::vector<ConfidenceMap>& second,
                                                           FunctionRef<size_t(const Query&)> limit) const;
  std::vector<ConfidenceMap> Predict(const std::vector<Query>& queries, const std::vector<ConfidenceMap>& second) const;

  FeatureSource features_;
  const std::vector<LoadedView>& views_;
  Calibrator calibrator_;
};

}  // namespace oraclegs
