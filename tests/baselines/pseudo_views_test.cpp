#include "oraclegs/baselines/pseudo_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

using Eigen::Vector3d;

/// A camera of this width at a place, rotated about y.
Camera Turned(int width, const Vector3d& center, double angle) {
  Camera camera{width, 10, 20, 20, width / 2.0, 5, Eigen::Isometry3d::Identity()};
  camera.cam_from_world.linear() = Eigen::AngleAxisd(angle, Vector3d::UnitY()).toRotationMatrix();
  camera.cam_from_world.translation() = -(camera.cam_from_world.linear() * center);
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

TEST(PseudoViewsBetween, FollowsTheSeedAlone) {
  const std::vector<Camera> cameras = {Turned(10, {0, 0, 0}, 0.2), Turned(20, {2, 0, 1}, 0.6),
                                       Turned(30, {2, 3, 0}, 1.0)};
  EXPECT_TRUE(SamePoses(PseudoViewsBetween(cameras, 9, 1), PseudoViewsBetween(cameras, 9, 1)));
  EXPECT_FALSE(SamePoses(PseudoViewsBetween(cameras, 9, 1), PseudoViewsBetween(cameras, 9, 2)));
}

TEST(PseudoViewsBetween, NeedsCameras) { EXPECT_THROW(PseudoViewsBetween({}, 3, 1), UsageError); }

TEST(DrawPseudoView, DrawsAllOfThemAlike) {
  std::vector<Camera> views;
  for (int i = 0; i < 4; ++i) views.push_back(Turned(10 + i, {0, 0, 0}, 0));
  std::vector<int> drawn(4);
  for (int64_t iteration = 1; iteration <= 400; ++iteration) {
    const Camera& view = DrawPseudoView(views, 7, iteration);
    EXPECT_EQ(&view, &DrawPseudoView(views, 7, iteration));
    ++drawn[static_cast<size_t>(view.width - 10)];
  }
  for (const int count : drawn) EXPECT_NEAR(count, 100, 40);
}

}  // namespace
}  // namespace oraclegs
