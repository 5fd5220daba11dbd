#include "oraclegs/train/camera_steps.h"

#include <gtest/gtest.h>

#include "oraclegs/camera/similarity.h"
#include "render/scenes.h"

namespace oraclegs {
namespace {

constexpr double kDegree = EIGEN_PI / 180;

/// A photo of a scene, taken by the rasterizer itself from a camera that says it stood elsewhere.
TrainView PhotoFrom(const Gaussians& scene, const Eigen::Vector3d& turn, const Eigen::Vector3d& shift) {
  TrainView view{"photo", FrontCamera(96, 72), {}, {}};
  view.image = MakeRasterizer(kCpu)->Forward(scene, view.camera, {}, RenderPass::kInference).image.Clone();
  view.camera.cam_from_world = Nudged(view.camera.cam_from_world, turn, shift);
  return view;
}

/// Degrees between a pose and FrontCamera's.
double DegreesOff(const Camera& camera) { return Eigen::AngleAxisd(camera.cam_from_world.linear()).angle() / kDegree; }

TEST(PoseAdam, TakesItsFirstStepAgainstTheSignOfTheGradient) {
  PoseAdam adam;
  const CameraGradient gradient{{3, -4, 1e-3}, {-7, 0, 2}, 0, 0, 0, 0};
  const Eigen::Isometry3d start = Nudged(Eigen::Isometry3d::Identity(), {0.3, 0.2, 0.1}, {1, 2, 3});
  const Eigen::Isometry3d after = adam.Step(start, gradient, 0, 1e-3);  // turns about its own center
  EXPECT_NEAR((after.matrix() - Nudged(start, {4e-3, 0, -4e-3}, {0, 0, 0}).matrix()).norm(), 0, 1e-9);
  EXPECT_EQ(adam.step, 1);
}

TEST(PoseAdam, TurnsAboutThePointInView) {
  const Eigen::Isometry3d start = Nudged(Eigen::Isometry3d::Identity(), {0.3, 0.2, 0.1}, {1, 2, 3});
  // Where no shift changes the loss, the point in view stays where it is.
  const CameraGradient gradient{{0, 0, 0}, {1, 0, 0}, 0, 0, 0, 0};
  PoseAdam adam;
  const Eigen::Isometry3d after = adam.Step(start, gradient, 5, 1e-3);
  const Eigen::Vector3d in_view = start.inverse() * Eigen::Vector3d(0, 0, 5);
  EXPECT_NEAR((after * in_view - Eigen::Vector3d(0, 0, 5)).norm(), 0, 1e-12);
  EXPECT_NEAR(Eigen::AngleAxisd((after * start.inverse()).linear()).angle(), 4e-3, 1e-9);
  // Where a turn about the center helps only because it shifts the picture, the camera shifts.
  PoseAdam other;
  const Eigen::Isometry3d shifted = other.Step(start, {{0, 1, 0}, {-5, 0, 0}, 0, 0, 0, 0}, 5, 1e-3);
  EXPECT_NEAR((shifted.matrix() - Nudged(start, {0, 0, 0}, {0, -5e-3, 0}).matrix()).norm(), 0, 1e-9);
}

TEST(AlignCamera, FindsATurnedCamera) {
  const Gaussians scene = RandomGaussians(300, 0.1, 5);
  const TrainView view = PhotoFrom(scene, Eigen::Vector3d(2, -2, 1) / 3 * 0.3 * kDegree, {0, 0, 0});
  ASSERT_NEAR(DegreesOff(view.camera), 0.3, 1e-6);
  const AlignedCamera aligned = AlignCamera(MakeRasterizer(kCpu).get(), scene, view, {});
  EXPECT_LT(DegreesOff(aligned.camera), 0.01);
  EXPECT_LT(aligned.camera.cam_from_world.translation().norm(), 0.001);
  EXPECT_LT(aligned.loss, 0.1 * aligned.loss_before);
  EXPECT_EQ(aligned.camera.fx, view.camera.fx);
}

TEST(AlignCamera, FindsACameraThatIsElsewhereFromUnmaskedPixels) {
  const Gaussians scene = RandomGaussians(300, 0.1, 5);
  TrainView view = PhotoFrom(scene, {0.002, 0.003, -0.004}, {0.02, -0.03, 0.02});
  view.pixel_weight = Buffer<float>::Full({72, 96}, 1.f);
  for (int64_t i = 0; i < 72 * 96; ++i) {
    if (i % 96 >= 30) continue;
    view.pixel_weight[i] = 0;
    for (int64_t c = 0; c < 3; ++c) view.image[3 * i + c] = 0.5f;  // a thumb
  }
  const AlignedCamera aligned = AlignCamera(MakeRasterizer(kCpu).get(), scene, view, {});
  EXPECT_LT(DegreesOff(aligned.camera), 0.02);
  EXPECT_LT(aligned.camera.cam_from_world.translation().norm(), 0.003);
}

TEST(AlignCamera, LeavesACameraThatNothingImproves) {
  const Gaussians scene = RandomGaussians(100, 0.1, 5);
  auto rasterizer = MakeRasterizer(kCpu);
  const TrainView good = PhotoFrom(scene, {0, 0, 0}, {0, 0, 0});
  EXPECT_EQ(AlignCamera(rasterizer.get(), scene, good, {}, {5, 1e-3}).camera.cam_from_world.matrix(),
            good.camera.cam_from_world.matrix());
  const TrainView behind = PhotoFrom(scene, {0, EIGEN_PI, 0}, {0, 0, 0});
  EXPECT_EQ(AlignCamera(rasterizer.get(), scene, behind, {}).camera.cam_from_world.matrix(),
            behind.camera.cam_from_world.matrix());
  const TrainView astray = PhotoFrom(scene, {0.003, 0, 0}, {0, 0, 0});
  const AlignedCamera undone = AlignCamera(rasterizer.get(), scene, astray, {}, {3, 1.0});
  EXPECT_LE(undone.loss, undone.loss_before);
  EXPECT_EQ(undone.camera.cam_from_world.matrix(), astray.camera.cam_from_world.matrix());
}

TEST(AlignCamera, RefusesAPhotoOfAnotherSize) {
  const Gaussians scene = RandomGaussians(10, 0.1, 5);
  TrainView view = PhotoFrom(scene, {0, 0, 0}, {0, 0, 0});
  view.camera.width = 95;
  auto rasterizer = MakeRasterizer(kCpu);
  EXPECT_THROW(AlignCamera(rasterizer.get(), scene, view, {}), ShapeError);
  EXPECT_THROW(rasterizer->camera_gradient(), ShapeError);
}

}  // namespace
}  // namespace oraclegs
