#include "oraclegs/train/baselines/pseudo_views.h"

#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/camera/camera_path.h"
#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

using Eigen::Vector3d;

/// Of this width, at a place, turned about y.
Camera Turned(int width, const Vector3d& center, double angle) {
  Camera camera{width, 10, 20, 20, width / 2.0, 5, Eigen::Isometry3d::Identity()};
  camera.cam_from_world.linear() = Eigen::AngleAxisd(angle, Vector3d::UnitY()).toRotationMatrix();
  camera.cam_from_world.translation() = -(camera.cam_from_world.linear() * center);
  return camera;
}

Camera Looking(const Vector3d& center, const Vector3d& target, const Vector3d& up) {
  Camera camera{20, 10, 20, 20, 10, 5, Eigen::Isometry3d::Identity()};
  camera.cam_from_world = LookAt(center, target, up);
  return camera;
}

bool SamePoses(const std::vector<Camera>& a, const std::vector<Camera>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Camera& x, const Camera& y) {
    return x.cam_from_world.matrix() == y.cam_from_world.matrix() && x.width == y.width;
  });
}

TEST(PseudoViewsBetween, LieOnSegmentsOfNearestCameras) {
  // Nearest of each: b, a, b. The way from a to b is 2 long, that from c to b is 3.
  const std::vector<Camera> cameras = {Turned(10, {0, 0, 0}, 0.2), Turned(20, {2, 0, 0}, 0.6),
                                       Turned(30, {2, 3, 0}, 1.0)};
  const auto views = PseudoViewsBetween(cameras, 200, 1, 0);
  ASSERT_EQ(views.size(), 200U);
  int on_first = 0;
  for (const Camera& view : views) {
    view.Check("view");
    const Vector3d c = view.Center();
    const bool first = c.x() < 2 - 1e-9;
    on_first += first;
    EXPECT_NEAR(c.z(), 0, 1e-12);
    EXPECT_NEAR(first ? c.y() : c.x(), first ? 0 : 2, 1e-12);
    const Eigen::AngleAxisd rotation(view.cam_from_world.linear());
    EXPECT_NEAR(rotation.angle() * rotation.axis().y(), first ? 0.4 : 0.8, 1e-9);
    const int width = first ? (c.x() < 1 ? 10 : 20) : (c.y() < 1.5 ? 20 : 30);
    EXPECT_EQ(view.width, width);
  }
  EXPECT_NEAR(on_first, 133, 30);  // two of three cameras
}

TEST(PseudoViewsBetween, NoiseIsRelativeToTheDistance) {
  const std::vector<Camera> cameras = {Turned(10, {0, 0, 0}, 0), Turned(10, {4, 0, 0}, 0)};
  double sum = 0;
  for (const Camera& view : PseudoViewsBetween(cameras, 4000, 1, 0.25)) sum += view.Center().tail<2>().squaredNorm();
  EXPECT_NEAR(std::sqrt(sum / 8000), 1, 0.05);
}

TEST(PseudoViewsBetween, OneCameraIsItself) {
  const std::vector<Camera> one = {Turned(10, {1, 2, 3}, 0.3)};
  for (const Camera& view : PseudoViewsBetween(one, 3, 1)) {
    EXPECT_TRUE(view.cam_from_world.isApprox(one[0].cam_from_world, 1e-12));
  }
}

TEST(PseudoViewsInBox, FillTheBoxAndLookAtOnePoint) {
  const std::vector<Camera> cameras = {Turned(10, {-1, -2, 0}, 0), Turned(10, {1, 2, 0.5}, 0),
                                       Turned(10, {0, 0, -0.5}, 0)};
  const auto views = PseudoViewsInBox(cameras, {2, 30}, 500, 3);
  const double focal = 1 / (0.25 / 1.8 + 0.75 / 150);
  Vector3d largest = Vector3d::Zero();
  for (const Camera& view : views) {
    view.Check("view");
    largest = largest.cwiseMax(view.Center().cwiseAbs());
    const Vector3d target = view.cam_from_world * Vector3d(0, 0, focal);
    EXPECT_NEAR(target.x(), 0, 1e-9);
    EXPECT_NEAR(target.y(), 0, 1e-9);
    EXPECT_GT(target.z(), 0);
  }
  EXPECT_TRUE((largest.array() <= Eigen::Array3d(1, 2, 0.5)).all()) << largest;
  EXPECT_TRUE((largest.array() >= Eigen::Array3d(0.95, 1.9, 0.475)).all()) << largest;
}

TEST(PseudoViewsOnEllipse, GoAroundWhatTheCamerasLookAt) {
  std::vector<Camera> cameras;  // on an ellipse around (5, 6, 7) with semi-axes 4 and 2, up along z
  const Vector3d focus(5, 6, 7);
  for (int i = 0; i < 40; ++i) {
    const double a = i * 6.283185307179586 / 40;
    cameras.push_back(Looking(focus + Vector3d(4 * std::cos(a), 2 * std::sin(a), 0), focus, Vector3d::UnitZ()));
  }
  double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
  const auto views = PseudoViewsOnEllipse(cameras, 500, 3);
  // The 90th percentile of |cos| over the circle.
  const double part = std::cos(6.283185307179586 / 40 * 1);
  for (const Camera& view : views) {
    view.Check("view");
    const Vector3d c = view.Center() - focus;
    EXPECT_NEAR(c.z(), 0, 1e-9);
    EXPECT_NEAR(std::pow(c.x() / 4, 2) + std::pow(c.y() / 2, 2), part * part, 0.05);
    EXPECT_LT((view.Forward() - (focus - view.Center()).normalized()).norm(), 1e-9);
    EXPECT_LT(view.cam_from_world.linear().row(1).dot(Vector3d::UnitZ()), 0);  // y points down
    for (int axis : {0, 1}) {
      low[axis] = std::min(low[axis], c[axis]);
      high[axis] = std::max(high[axis], c[axis]);
    }
  }
  EXPECT_NEAR(high[0], 4 * part, 0.05);
  EXPECT_NEAR(low[0], -4 * part, 0.05);
  EXPECT_NEAR(high[1], 2 * part, 0.05);
  EXPECT_NEAR(low[1], -2 * part, 0.05);
}

TEST(PseudoViews, FollowTheSeedAlone) {
  const std::vector<Camera> cameras = {Turned(10, {0, 0, 0}, 0.2), Turned(20, {2, 0, 1}, 0.6),
                                       Turned(30, {2, 3, 0}, 1.0)};
  EXPECT_TRUE(SamePoses(PseudoViewsBetween(cameras, 9, 1), PseudoViewsBetween(cameras, 9, 1)));
  EXPECT_FALSE(SamePoses(PseudoViewsBetween(cameras, 9, 1), PseudoViewsBetween(cameras, 9, 2)));
  EXPECT_TRUE(SamePoses(PseudoViewsInBox(cameras, {1, 2}, 9, 1), PseudoViewsInBox(cameras, {1, 2}, 9, 1)));
  EXPECT_FALSE(SamePoses(PseudoViewsInBox(cameras, {1, 2}, 9, 1), PseudoViewsInBox(cameras, {1, 2}, 9, 2)));
  EXPECT_TRUE(SamePoses(PseudoViewsOnEllipse(cameras, 9, 1), PseudoViewsOnEllipse(cameras, 9, 1)));
  EXPECT_FALSE(SamePoses(PseudoViewsOnEllipse(cameras, 9, 1), PseudoViewsOnEllipse(cameras, 9, 2)));
}

TEST(PseudoViews, NeedCamerasAndBounds) {
  EXPECT_THROW(PseudoViewsBetween({}, 3, 1), UsageError);
  EXPECT_THROW(PseudoViewsOnEllipse({}, 3, 1), UsageError);
  EXPECT_THROW(PseudoViewsInBox({}, {1, 2}, 3, 1), UsageError);
  EXPECT_THROW(PseudoViewsInBox({Turned(10, {0, 0, 0}, 0)}, {0, 2}, 3, 1), UsageError);
  EXPECT_THROW(PseudoViewsInBox({Turned(10, {0, 0, 0}, 0)}, {3, 2}, 3, 1), UsageError);
}

}  // namespace
}  // namespace oraclegs
