#pragma once
// A scene small enough to be trained in a test: a few Gaussians, photoed by the rasterizer itself.

#include <algorithm>

#include "oraclegs/render/render.h"
#include "oraclegs/train/checkpoint_folder.h"
#include "oraclegs/train/trainer.h"
#include "train/gaussian_fixtures.h"

namespace oraclegs {

inline constexpr int kWidth = 37, kHeight = 29;
inline constexpr uint64_t kSeed = 11;

/// A camera on a circle of radius 3 that looks at the origin.
inline Camera CameraOnCircle(double angle) {
  Camera camera{kWidth, kHeight, 40, 40, kWidth / 2.0, kHeight / 2.0, Eigen::Isometry3d::Identity()};
  camera.cam_from_world.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
  camera.cam_from_world.translation() = Eigen::Vector3d(0, 0, 3);
  return camera;
}

/// A few colored Gaussians around the origin.
inline Gaussians Truth() {
  Gaussians truth = RandomGaussians(40, 21);
  Flat(truth.means) *= 0.4f;
  Flat(truth.opacity_logits).setConstant(2);
  Table(truth.sh).rightCols(45).setZero();
  return truth;
}

/// Photos of the scene, taken by the rasterizer itself.
inline std::vector<TrainView> Photos(int count) {
  const Gaussians truth = Truth();
  auto rasterizer = MakeRasterizer(kCpu);
  std::vector<TrainView> views;
  for (int i = 0; i < count; ++i) {
    TrainView view{"photo" + std::to_string(i), CameraOnCircle(0.3 * i), {}, {}};
    view.image = rasterizer->Forward(truth, view.camera, {}, RenderPass::kInference).image.Clone();
    views.push_back(view);
  }
  return views;
}

inline Gaussians Start(int64_t n = 60) {
  Gaussians start = RandomGaussians(n, 22);
  Flat(start.means) *= 0.5f;
  Flat(start.log_scales).setConstant(-2.5f);
  start.opacity_logits.SetZero();
  Flat(start.opacity_logits).head(std::min<int64_t>(5, n / 2)).setConstant(-7);  // dead, to be relocated
  start.sh.SetZero();
  return start;
}

/// Options that refine at 40, 50, ..., so that every kind of event happens within 100 iterations.
inline TrainOptions Options(int iterations = 100) {
  TrainOptions options;
  options.iterations = iterations;
  options.max_gaussians = 80;
  options.refine_start = 30;
  options.refine_every = 10;
  options.sh_degree_interval = 20;
  return options;
}

}  // namespace oraclegs
