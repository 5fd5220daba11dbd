#pragma once

#include <vector>

#include "oraclegs/depth/fusion.h"
#include "oraclegs/pipeline/run.h"
#include "oraclegs/scene/photos.h"

namespace oraclegs {

/// Exposures that spread by more than this (ExposureSpread) are taken for real, and learnt by --exposure auto. Gloss
/// and shadow alone make 0.07 of photographs of one exposure (lego); a phone that holds its exposure 0.10 (fox).
inline constexpr double kVariedExposure = 0.15;

/// What stereo found in the training photographs.
struct Geometry {
  std::string key;                     ///< of what it was found from; empty without stereo
  std::vector<DepthMap> maps;          ///< one for each photograph
  std::vector<DensePoint> points;      ///< fused; in the mean exposure of the photographs where exposures vary
  std::vector<Eigen::Vector3f> gains;  ///< of the photographs' exposures (depth/gains.h)
};

/// How photographs of such exposures are fused: colours are freed of them where they vary.
FusionOptions FusionOf(const std::vector<Eigen::Vector3f>& gains);

/// Stage "depth": multi-view stereo over the training photographs, in the order of the split. Writes depth/ and
/// sfm/dense.ply; read back when photographs, points and options are unchanged. `points` are those of stage "sfm".
/// Tells what share of the pixels is confident, and warns of photographs of which next to nothing is.
Geometry RunDepth(Run* run, const std::vector<Photo>& photos, const std::vector<ScenePoint>& points);

}  // namespace oraclegs
