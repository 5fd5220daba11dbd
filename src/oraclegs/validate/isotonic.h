#pragma once

#include <utility>
#include <vector>

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

}  // namespace oraclegs
