#pragma once
// Poses refined by what dense stereo sees: bundle adjustment of patches (docs/method.md#pose-refinement).

#include <string>
#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/depth/depth_map.h"
#include "oraclegs/depth/pose_movement.h"
#include "oraclegs/scene/loaded_view.h"

namespace oraclegs {

struct PoseRefinementOptions {
  double gate = 0.25;   ///< pixels: poses are kept where the residual is below it, and each view's below twice that
  double enough = 0.5;  ///< poses are kept unless the views' residuals fall to this share: good poses gain less
  int rounds = 3;       ///< of measuring and solving
  size_t pixels_per_view = 2500;  ///< with up to five offsets each
};

enum class PoseRefinementResult {
  kUnknown,  ///< too few patches were found to say anything
  kKept,     ///< the residuals are below the gate
  kRefined,
  kUndone,  ///< a residual is above the gate, but residuals did not fall enough, or a camera moved too far
};

/// How far patches lie from their epipolar lines (AcrossResidual), pixels of the views' images, before and after.
struct PoseResidual {
  double before = 0, after = 0;
};

struct RefinedView {
  std::string name;
  PoseResidual residual;
  CameraMovement movement;  ///< zero unless refined; where undone, what was undone
};

struct PoseRefinement {
  PoseRefinementResult result = PoseRefinementResult::kUnknown;
  std::vector<Camera> cameras;  ///< of the views; unchanged unless refined
  PoseResidual residual;
  std::vector<RefinedView> views;
  size_t offsets = 0;  ///< patches behind the residual
};

/// Whether poses with these residuals, of all views and of each (ResidualAcross), pass the gate.
bool PassesGate(double all, const std::vector<double>& views, double gate);

/// The share of the residuals that refinement left: their sum over the views that have one before and after; 1 without
/// such views.
double LeftShare(const std::vector<RefinedView>& views);

/// Largest movement of a camera that is believed, degrees and share of the scene extent.
inline constexpr double kMaxPoseDegrees = 3, kMaxPoseShare = 0.03;

/// True where no camera moved further.
bool IsBelieved(const std::vector<CameraMovement>& movements);

/// Refines the poses of the views. `maps` are their depth maps (EstimateDepth), made with the same cameras. The first
/// camera and the length of the longest baseline stay; other cameras of the scene go along by Following. Depths are
/// those of the given poses: where poses moved, stereo has to run again, and with its depths a second refinement (with
/// a gate of 0) finds what is left. The result does not depend on the number of threads. Throws Interrupted.
PoseRefinement RefinePoses(const std::vector<LoadedView>& views, const std::vector<DepthMap>& maps,
                           const PoseRefinementOptions& options);

}  // namespace oraclegs
