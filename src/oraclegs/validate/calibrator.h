#pragma once
// From the features of pixels to confidence: which pixel is better (order), and how good it is (level). Both are
// learned from pixels whose error is known (docs/method.md#calibration).

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/validate/logistic.h"

namespace oraclegs {

/// Non-decreasing step function nearest to samples (x, y) in least squares, by pooling adjacent violators [Ayer 1955],
/// for calibration [Zadrozny 2002]. Values between the middles of its steps are interpolated linearly.
class Isotonic {
 public:
  /// Identity.
  Isotonic() = default;
  /// Fits samples in any order; the identity when there are none.
  static Isotonic Fit(std::vector<std::pair<float, float>> samples);
  float operator()(float x) const;

 private:
  std::vector<float> x_, y_;  ///< ascending
};

/// Pixels of a proposal with their features and their known errors.
struct PixelSamples {
  size_t columns = 0;
  std::vector<float> rows;    ///< samples * columns
  std::vector<float> errors;  ///< RMS over the channels of colors in [0, 1]

  void Append(const PixelSamples& more);
};

/// Model of the similarity of a proposer's pixels, given their features.
struct PixelModel {
  Logistic order;  ///< rises with the expected similarity
  Isotonic level;  ///< maps `order` to the similarity; the identity where it is not fitted
};

enum class LevelRule {
  kFitted,  ///< confidence estimates the similarity
  kAsIs,    ///< confidence is the output of the regression
};

/// A model for each proposer, and one for proposers without training samples.
class Calibrator {
 public:
  explicit Calibrator(LevelRule rule = LevelRule::kFitted) : rule_(rule) {}

  /// Fits models to samples with the names of their proposers; a proposer fitted before gets a new model. Throws
  /// InputError when there are no samples.
  void Fit(const std::vector<std::pair<std::string, PixelSamples>>& samples);

  bool fitted() const { return any_.has_value(); }
  /// Model of the proposer; for one without training samples, that of the first Fit, which joins all its proposers.
  /// Requires fitted().
  const PixelModel& ModelOf(const std::string& source) const;

 private:
  PixelModel FitOne(const PixelSamples& samples) const;

  LevelRule rule_;
  std::map<std::string, PixelModel> by_source_;
  std::optional<PixelModel> any_;
};

}  // namespace oraclegs
