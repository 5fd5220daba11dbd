#pragma once

#include <utility>
#include <vector>

namespace oraclegs {

/// The non-decreasing step function nearest to samples (x, y) in least squares, by pooling adjacent violators [Ayer
/// 1955], for calibration [Zadrozny 2002], read with linear interpolation between the middles of its steps.
class Isotonic {
 public:
  /// The identity.
  Isotonic() = default;
  /// Of samples in any order; the identity when there are none.
  static Isotonic Fit(std::vector<std::pair<float, float>> samples);
  float operator()(float x) const;

 private:
  std::vector<float> x_, y_;  ///< ascending
};

}  // namespace oraclegs
