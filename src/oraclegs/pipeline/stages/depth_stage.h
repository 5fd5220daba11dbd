#pragma once

#include <vector>

#include "oraclegs/depth/fusion.h"
#include "oraclegs/pipeline/run.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

/// Exposures that spread by more than this (ExposureSpread) are taken for real, and learnt by --exposure auto. Gloss
/// and shadow alone make 0.07 of photographs of one exposure (lego); a phone that holds its exposure 0.10 (fox).
inline constexpr double kVariedExposure = 0.15;

/// The depth of the training photographs, from stereo, a network or both (--depth-prior).
struct Geometry {
  std::string key;             ///< of what it was found from; empty without depth
  std::vector<DepthMap> maps;  ///< one for each photograph
  /// Fused; in the mean exposure of the photographs where exposures vary. With what a network guesses where confident
  /// pixels give few.
  std::vector<DensePoint> points;
  std::vector<Eigen::Vector3f> gains;  ///< of the photographs' exposures (depth/gains.h)
};

/// How photographs of such exposures are fused: colours are freed of them where they vary.
FusionOptions FusionOf(const std::vector<Eigen::Vector3f>& gains);

/// Fewer points than this are joined by a network's, where there is one.
inline constexpr size_t kFewDensePoints = 1000;

/// Stage "depth": multi-view stereo over the training photographs, in the order of the split, and what Depth Anything
/// V2 guesses of each (--depth-prior). Writes depth/ and sfm/dense.ply; read back when photographs, points, options and
/// weights are unchanged, whatever --device. `points` are those of stage "sfm". Tells what share of the pixels is
/// confident, how often the network was right, or what brings its weights where it is missed; warns of photographs of
/// which next to nothing is known. Throws UsageError for --depth-prior none and for a device that cannot be used,
/// InputError for weights that are missing or damaged.
Geometry RunDepth(Run* run, const std::vector<LoadedView>& photos, const std::vector<ScenePoint>& points);

}  // namespace oraclegs
