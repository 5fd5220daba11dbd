#pragma once
// Sources of the features by which an oracle classifies pixels: the images, the prediction of another oracle, or both.

#include <array>
#include <string>
#include <vector>

#include "oraclegs/core/function_ref.h"
#include "oraclegs/propose/warp.h"
#include "oraclegs/validate/comparison.h"
#include "oraclegs/validate/features.h"
#include "oraclegs/validate/oracle.h"

namespace oraclegs {

/// Evidence about a pixel.
enum class Evidence {
  kImages,  ///< the features of validate/features.h
  kSecond,  ///< prediction of a second oracle only
  kBoth,
};

/// Thoroughness of the comparison of proposals with the images.
enum class Scrutiny {
  kPlain,     ///< the features only
  kThorough,  ///< also comparisons at several scales, with the warp and with the query's proxy render, if any
};

/// Features of a proposal's pixels, one row of numbers a pixel.
class PixelRows {
 public:
  static constexpr size_t kMaxColumns = kFeatures + 2 * kComparisons + 1;
  using Space = std::array<float, kMaxColumns>;

  /// Each argument may be empty. `second` must outlive it.
  PixelRows(std::vector<Features> features, std::vector<std::vector<Comparison>> comparisons,
            const ConfidenceMap& second)
      : features_(std::move(features)), comparisons_(std::move(comparisons)), second_(second) {}

  size_t size() const { return features_.empty() ? second_.size() : features_.size(); }
  size_t columns() const {
    return (features_.empty() ? 0 : kFeatures) + comparisons_.size() * kComparisons + (second_.empty() ? 0 : 1);
  }
  /// Row of a pixel; `space` holds it where it is not stored as a whole.
  const float* Row(size_t pixel, Space* space) const;

 private:
  std::vector<Features> features_;
  std::vector<std::vector<Comparison>> comparisons_;
  const ConfidenceMap& second_;
};

/// The referenced objects must outlive it.
class FeatureSource {
 public:
  /// Features from the images.
  explicit FeatureSource(const Warper& warper) : warper_(warper) {}
  /// Features from another oracle's prediction, alone or joined with those from the images.
  FeatureSource(const Warper& warper, const Oracle& second, Evidence evidence)
      : warper_(warper), evidence_(evidence), second_(&second) {}

  /// Copy that compares every proposal thoroughly. Either all of its queries have a proxy render, or none has.
  FeatureSource Thorough() const;

  /// "consistency", the second oracle's name, or that + "+consistency".
  std::string name() const;
  bool ReadsImages() const { return evidence_ != Evidence::kSecond; }
  const Warper& warper() const { return warper_; }

  /// Predictions of the second oracle for each query; empty maps without one.
  std::vector<ConfidenceMap> SecondMaps(const std::vector<Query>& queries) const;

  /// Calls use(q, rows) for each query, views in parallel; queries of one view share its warp. `second` is the result
  /// of SecondMaps for the queries. Throws Interrupted.
  void ForEach(const std::vector<Query>& queries, const std::vector<ConfidenceMap>& second,
               FunctionRef<void(size_t, const PixelRows&)> use) const;

 private:
  const Warper& warper_;
  Evidence evidence_ = Evidence::kImages;
  const Oracle* second_ = nullptr;
  Scrutiny scrutiny_ = Scrutiny::kPlain;
};

}  // namespace oraclegs
