#pragma once

#include <vector>

#include "oraclegs/experiments/tampered_views.h"
#include "oraclegs/experiments/tampering_report.h"

namespace oraclegs {

/// What is known of one proposal's pixels.
struct CheckedPixels {
  PixelMask confidence;  ///< [0, 255]
  PixelMask tampered;
  PixelMask unseen;  ///< at most one photo sees it
  PixelKinds kinds;
};

/// What a confidence says of pixels that are known to be tampered with, over all proposals together.
class ConfidenceCheck {
 public:
  /// Throws ShapeError unless all are of one size.
  void Add(const CheckedPixels& proposal);

  /// The numbers of the pixels; seed, share and lies are not set.
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
