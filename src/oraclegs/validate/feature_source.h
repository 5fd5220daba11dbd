#pragma once
// Where the features come from by which an oracle classifies pixels: what the images show there, what another oracle
// predicts, or both.

#include <array>
#include <string>
#include <vector>

#include "oraclegs/core/function_ref.h"
#include "oraclegs/propose/warp.h"
#include "oraclegs/validate/comparison.h"
#include "oraclegs/validate/features.h"
#include "oraclegs/validate/oracle.h"

namespace oraclegs {

/// What is known of a pixel before it is classified.
enum class Evidence {
  kImages,  ///< the features of validate/features.h
  kSecond,  ///< what a second oracle predicts, alone
  kBoth,
};

/// How closely proposals are compared with what the images show.
enum class Scrutiny {
  kPlain,     ///< by the features alone
  kThorough,  ///< at several scales, with the warp and with the query's proxy render where it has one
};

/// The features of each pixel of a proposal, as one row of numbers for each.
class PixelRows {
 public:
  static constexpr size_t kMaxColumns = kFeatures + 2 * kComparisons + 1;
  using Space = std::array<float, kMaxColumns>;

  /// Each may be empty. `second` must outlive it.
  PixelRows(std::vector<Features> features, std::vector<std::vector<Comparison>> comparisons,
            const ConfidenceMap& second)
      : features_(std::move(features)), comparisons_(std::move(comparisons)), second_(second) {}

  size_t size() const { return features_.empty() ? second_.size() : features_.size(); }
  size_t columns() const {
    return (features_.empty() ? 0 : kFeatures) + comparisons_.size() * kComparisons + (second_.empty() ? 0 : 1);
  }
  /// The row of a pixel, in `space` where it is not stored as a whole.
  const float* Row(size_t pixel, Space* space) const;

 private:
  std::vector<Features> features_;
  std::vector<std::vector<Comparison>> comparisons_;
  const ConfidenceMap& second_;
};

/// What is referenced must outlive it.
class FeatureSource {
 public:
  /// What the images show.
  explicit FeatureSource(const Warper& warper) : warper_(warper) {}
  /// What another oracle predicts, alone or as one more feature.
  FeatureSource(const Warper& warper, const Oracle& second, Evidence evidence)
      : warper_(warper), evidence_(evidence), second_(&second) {}

  /// The same, with every proposal compared thoroughly. All queries of it have a proxy render, or none has.
  FeatureSource Thorough() const;

  /// "consistency", the second oracle's name, or that + "+consistency".
  std::string name() const;
  bool ReadsImages() const { return evidence_ != Evidence::kSecond; }
  const Warper& warper() const { return warper_; }

  /// What the second oracle predicts of each; empty maps without one.
  std::vector<ConfidenceMap> SecondMaps(const std::vector<Query>& queries) const;

  /// Calls use(q, rows) for each query, views in parallel; queries of one view share its warp. `second` are their
  /// SecondMaps. Throws Interrupted.
  void ForEach(const std::vector<Query>& queries, const std::vector<ConfidenceMap>& second,
               FunctionRef<void(size_t, const PixelRows&)> use) const;

 private:
  const Warper& warper_;
  Evidence evidence_ = Evidence::kImages;
  const Oracle* second_ = nullptr;
  Scrutiny scrutiny_ = Scrutiny::kPlain;
};

}  // namespace oraclegs
