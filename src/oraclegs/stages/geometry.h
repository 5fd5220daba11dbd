#pragma once

#include <vector>

#include "oraclegs/depth/depth_map.h"
#include "oraclegs/depth/fusion.h"

namespace oraclegs {

/// Exposures that spread by more than this (ExposureSpread) really differ, and are learned by --exposure auto. Gloss
/// and shadow alone make 0.07 of images of one exposure (lego); a phone that holds its exposure 0.10 (fox).
inline constexpr double kVariedExposure = 0.15;

/// The depth of the training views, from stereo, a network or both (--depth-prior).
struct Geometry {
  std::vector<DepthMap> maps;  ///< one for each view; empty without depth
  /// Fused; in the mean exposure of the images where exposures vary. With what a network predicts where confident
  /// pixels give few.
  std::vector<DensePoint> points;
  std::vector<Eigen::Vector3f> gains;  ///< gains of the images' exposures (depth/gains.h)

  bool HasVariedExposure() const;
};

/// How images of such exposures are fused: colors are freed of them where they vary.
FusionOptions FusionOf(const std::vector<Eigen::Vector3f>& gains);

}  // namespace oraclegs
