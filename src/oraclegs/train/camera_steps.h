#pragma once
// Cameras that move downhill: Adam on a pose, and the pose of one photo before a splat that stays as it is.

#include "oraclegs/render/render.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// Adam of one camera's pose. Gradients and moments are those of the camera's frame of the moment (CameraGradient): it
/// turns far too little for its axes to matter.
struct PoseAdam {
  Eigen::Vector3d turn_m = Eigen::Vector3d::Zero(), turn_v = Eigen::Vector3d::Zero();
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero(), shift_v = Eigen::Vector3d::Zero();
  int64_t step = 0;  ///< steps taken

  /// Returns the pose after one more step of `turn_rate` radians and `shift_rate` world units.
  Eigen::Isometry3d Step(const Eigen::Isometry3d& cam_from_world, const CameraGradient& gradient, double turn_rate,
                         double shift_rate);
};

struct CameraAlignOptions {
  int steps = 100;
  /// Radians of the first step; the last has a hundredth. A shift's step moves the picture as far, at the distance of
  /// what is seen.
  double turn_rate = 1e-3;
};

struct AlignedCamera {
  Camera camera;
  double loss_before = 0, loss = 0;  ///< L1 and SSIM as in training, of the view's camera and of this one
};

/// Searches near the view's camera for the pose whose render looks most like its image, by Adam on the pose alone. The
/// best pose on the way is returned, which may be the view's own: a search that goes astray is undone. `rasterizer`,
/// Gaussians and view are on one device. Throws ShapeError.
AlignedCamera AlignCamera(Rasterizer* rasterizer, const Gaussians& gaussians, const TrainView& view,
                          const RenderOptions& render, const CameraAlignOptions& options = {});

}  // namespace oraclegs
