#pragma once
// Oracle without network weights. It compares a proposal's pixels with the images, and learns from proposals of
// held-out training views how good such pixels are (docs/method.md#consistency-oracle).

#include <string>
#include <utility>
#include <vector>

#include "oraclegs/validate/calibrator.h"
#include "oraclegs/validate/feature_source.h"
#include "oraclegs/validate/oracle.h"

namespace oraclegs {

/// Confidence = the similarity that pixels with such features had in held-out views, smoothed where it comes from the
/// images (Smooth). It never reads a test view. The referenced objects must outlive it.
class ConsistencyOracle : public Oracle {
 public:
  ConsistencyOracle(FeatureSource features, const std::vector<LoadedView>& views, LevelRule rule = LevelRule::kFitted)
      : features_(features), views_(views), calibrator_(rule) {}

  /// Fits the models to proposals of held-out views; a source fitted before gets a new model. Throws InputError when
  /// all their pixels are masked, ShapeError for a query without a held-out view.
  void Calibrate(const std::vector<Query>& held_out);
  /// Calibrates, and returns the confidence of the same proposals. A second oracle predicts once for both.
  std::vector<ConfidenceMap> CalibrateAndPredict(const std::vector<Query>& held_out);

  /// Training samples from proposals of held-out views, at most `limit` of each, with the names of their sources, in
  /// their order. For proposals that are not all in memory at once. Throws ShapeError as Calibrate does.
  std::vector<std::pair<std::string, PixelSamples>> Sample(const std::vector<Query>& held_out, size_t limit) const;
  /// Calibrates with such samples.
  void Fit(const std::vector<std::pair<std::string, PixelSamples>>& samples) { calibrator_.Fit(samples); }

  /// Name of the features.
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

/// Replaces each pixel by the weighted mean of the 5x5 around it, with weights (1 4 6 4 1) along both axes, normalized
/// at the border. A prediction from one pixel's features is noisy; its neighbors show the same surface, and a misplaced
/// proposal is wrong on both sides of an edge. Throws ShapeError when the map has not width * height pixels.
void Smooth(int width, int height, ConfidenceMap* map);

}  // namespace oraclegs
