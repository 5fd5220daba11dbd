#pragma once
// Classifier-free guidance with a weight per frame (docs/method.md#seva-guidance).

#include <vector>

#include "oraclegs/networks/seva/cameras.h"

namespace oraclegs::seva {

/// Strength of guidance for conditioning frames and frames at the place of one, where guidance has little to add; the
/// value of SEVA's authors.
inline constexpr double kGuidanceBesideAnImage = 1.2;

/// Weights [T] float32: kGuidanceBesideAnImage for those frames, `cfg` for the others. Throws ShapeError unless `given`
/// (which frames condition) has one entry a view and a true one.
Tensor GuidanceWeights(const std::vector<View>& views, const std::vector<bool>& given, double cfg);

}  // namespace oraclegs::seva
