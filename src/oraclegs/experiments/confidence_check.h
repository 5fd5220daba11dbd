#pragma once

#include <vector>

#include "oraclegs/experiments/tampered_views.h"
#include "oraclegs/experiments/tampering_report.h"

namespace oraclegs {

/// Confidence of one proposal's pixels, and the truth about them.
struct CheckedPixels {
  PixelMask confidence;  ///< [0, 255]
  PixelMask tampered;
  PixelMask unseen;  ///< 255 where at most one photo sees the pixel
  PixelKinds kinds;
};

/// Compares confidences with the tampered pixels, over all proposals together.
class ConfidenceCheck {
 public:
  /// Throws ShapeError unless all are of one size.
  void Add(const CheckedPixels& proposal);

  /// Figures over the pixels; seed, share and lies are not set.
  TamperedConfidence Result() const;

 private:
  struct Pixels {
    std::vector<float> confidence;
    std::vector<bool> tampered;
    PixelKinds kinds;
  };
  Pixels seen_, unseen_;
};

}  // namespace oraclegs
