#pragma once
// From the features of pixels to confidence: which pixel is better (order), and how good it is (level). Both are
// learned from pixels whose error is known (docs/method.md#calibration).

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/validate/isotonic.h"
#include "oraclegs/validate/logistic.h"

namespace oraclegs {

/// Pixels of a proposal with their features and their known errors.
struct PixelSamples {
  size_t columns = 0;
  std::vector<float> rows;    ///< samples * columns
  std::vector<float> errors;  ///< RMS over the channels, of colors in [0, 1]

  void Append(const PixelSamples& more);
};

/// What a proposer's pixels of such features are worth.
struct PixelModel {
  Logistic order;  ///< rises with the expected similarity
  Isotonic level;  ///< of `order` to the similarity; the identity where it is not fitted
};

enum class LevelRule {
  kFitted,  ///< confidence estimates the similarity
  kAsIs,    ///< confidence is the regression's answer
};

/// A model for each proposer, and one for those of which nothing was learned.
class Calibrator {
 public:
  explicit Calibrator(LevelRule rule = LevelRule::kFitted) : rule_(rule) {}

  /// Learns from samples with the names of their proposers; a proposer that was learned before gets a new model. Throws
  /// InputError when there are no samples.
  void Fit(const std::vector<std::pair<std::string, PixelSamples>>& samples);

  bool fitted() const { return any_.has_value(); }
  /// The proposer's own model; for one that was not learned, that of the first Fit, all its proposers together. Only
  /// once fitted.
  const PixelModel& ModelOf(const std::string& source) const;

 private:
  PixelModel FitOne(const PixelSamples& samples) const;

  LevelRule rule_;
  std::map<std::string, PixelModel> by_source_;
  std::optional<PixelModel> any_;
};

}  // namespace oraclegs
