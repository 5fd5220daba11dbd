#pragma once
// Cameras that move downhill: Adam on a pose, and the pose of one photo before a splat that stays as it is.

#include "oraclegs/render/render.h"
#include "oraclegs/train/train_view.h"

namespace oraclegs {

/// Adam of one camera's pose. A turn about the camera's own center and a shift move the picture almost alike, and Adam,
/// which weighs each number by itself, crawls along the valley between them. So the camera turns about the point that
/// it looks at, which is parallax and little else. Moments stay those of the camera's axes: it turns too little to
/// matter.
struct PoseAdam {
  Eigen::Vector3d turn_m = Eigen::Vector3d::Zero(), turn_v = Eigen::Vector3d::Zero();
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero(), shift_v = Eigen::Vector3d::Zero();
  int64_t step = 0;  ///< steps taken

  /// Returns the pose after one more step. distance: of what the camera looks at, world units. rate: the picture moves
  /// by about so many radians per axis.
  Eigen::Isometry3d Step(const Eigen::Isometry3d& cam_from_world, const CameraGradient& gradient, double distance,
                         double rate);
};

struct CameraAlignOptions {
  int steps = 100;
  double rate = 1e-3;  ///< of the first step (PoseAdam), radians; the last has a hundredth
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
