#pragma once

#include <vector>

#include "oraclegs/experiments/tampered_views.h"
#include "oraclegs/experiments/tampering_report.h"

namespace oraclegs {

/// What a confidence says of pixels that are known to be tampered with, over all proposals together.
class ConfidenceCheck {
 public:
  /// One proposal: its confidence, [0, 255]; where it is tampered with; where at most one photo sees. Throws ShapeError
  /// unless all are of one size.
  void Add(const PixelMask& confidence, const PixelMask& tampered, const PixelMask& unseen);

  /// The numbers of the pixels; seed, share and lies are not set.
  TamperedConfidence Result() const;

 private:
  struct Pixels {
    std::vector<float> confidence;
    std::vector<bool> tampered;
  };
  Pixels seen_, unseen_;
};

}  // namespace oraclegs
