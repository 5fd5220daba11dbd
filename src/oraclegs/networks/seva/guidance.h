#pragma once
// Classifier-free guidance with a weight per frame (docs/method.md#seva-guidance).

#include <vector>

#include "oraclegs/networks/seva/cameras.h"
#include "oraclegs/networks/seva_options.h"

namespace oraclegs::seva {

/// kPlain: cfg everywhere. kMultiView: cfg, but cfg_min for conditioning frames and frames at the place of one.
/// kTemporal: from cfg_min to cfg with the distance, in frames, to a conditioning frame; the same exception.
struct Guidance {
  Guider guider = Guider::kMultiView;
  double cfg = 3, cfg_min = 1.2;
};

/// [T] float32. Throws ShapeError unless `given` (which frames condition) has one entry a view and a true one.
Tensor GuidanceWeights(const std::vector<View>& views, const std::vector<bool>& given, const Guidance& guidance);

}  // namespace oraclegs::seva
