#pragma once
// Classifier-free guidance with a weight per frame (docs/method.md#seva-guidance).

#include <vector>

#include "oraclegs/networks/seva/cameras.h"
#include "oraclegs/networks/seva_options.h"

namespace oraclegs::seva {

/// Strength of guidance. kPlain: cfg everywhere. kMultiView: cfg_min for conditioning frames and frames at the place of
/// one, cfg for others. kTemporal: from cfg_min to cfg with the distance, in frames, to a conditioning frame; with the
/// exception of kMultiView.
struct Guidance {
  Guider guider = Guider::kMultiView;
  double cfg = 3, cfg_min = 1.2;
};

/// Weights [T] float32. Throws ShapeError unless `given` (which frames condition) has one entry a view and a true one.
Tensor GuidanceWeights(const std::vector<View>& views, const std::vector<bool>& given, const Guidance& guidance);

}  // namespace oraclegs::seva
