#include "oraclegs/mesh/surface_view.h"

#include <gtest/gtest.h>

#include "mesh/views_of_shapes.h"

namespace oraclegs {
namespace {

TEST(SurfaceViewOf, BelievesAFloorUpToAGrazingAngle) {
  const Camera camera = ShapeCamera({0, 0, 1}, {4, 0, 0.6});
  const SurfaceView view = ViewOfShape(FloorAt(0), camera);
  const auto weight = [&](int x, int y) { return view.weights[static_cast<size_t>(y * camera.width + x)]; };
  EXPECT_GT(weight(48, 90), 0);
  EXPECT_GT(weight(48, 90), weight(48, 70)) << "near says more";
  EXPECT_EQ(weight(48, 41), 0) << "under the horizon";
  EXPECT_EQ(weight(48, 10), 0) << "above it";
  EXPECT_EQ(weight(0, 90), 0) << "the border has no neighbors";
}

TEST(SurfaceViewOf, LeavesOutTheOutline) {
  const Camera camera = ShapeCamera({4, 0, 0}, {0, 0, 0});
  const auto ball = SphereAt({0, 0, 0}, 1);
  const SurfaceView view = ViewOfShape(
      [&](const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
        const double z = ball(origin, ray);
        return z > 0 ? z : 8;  // a wall behind it
      },
      camera);
  int dropped = 0;
  for (int x = 1; x + 1 < camera.width; ++x) {
    const auto i = static_cast<size_t>(48 * camera.width + x);
    const bool edge = std::abs(view.surface.inv_depth[i] - view.surface.inv_depth[i + 1]) > 0.05f ||
                      std::abs(view.surface.inv_depth[i] - view.surface.inv_depth[i - 1]) > 0.05f;
    EXPECT_TRUE(!edge || view.weights[i] == 0) << x;
    dropped += view.weights[i] == 0 ? 1 : 0;
  }
  EXPECT_GE(dropped, 4);
  EXPECT_LT(dropped, 16);
}

TEST(SurfaceViewOf, IgnoresTransparentPixels) {
  RenderOutput render;
  const Camera camera = ShapeCamera({0, 0, 3}, {0, 0, 0}, 8);
  render.alpha = Buffer<float>::Full({8, 8}, 0.8f);
  render.inv_depth = Buffer<float>::Full({8, 8}, 0.4f);
  render.image = Buffer<float>::Zeros({8, 8, 3});
  for (const float weight : SurfaceViewOf(render, camera).weights) EXPECT_EQ(weight, 0);
}

}  // namespace
}  // namespace oraclegs
