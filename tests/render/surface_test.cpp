#include "oraclegs/render/surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "render/scenes.h"

namespace oraclegs {
namespace {

/// A render of this alpha, whose surface has depth z(ray) for the ray (x, y, 1).
RenderOutput RenderOfDepth(const Camera& camera, float alpha, const std::function<double(double, double)>& depth) {
  RenderOutput out;
  out.alpha = Buffer<float>::Full({camera.height, camera.width}, alpha);
  out.inv_depth = Buffer<float>::Empty({camera.height, camera.width});
  for (int64_t i = 0; i < out.alpha.count(); ++i) {
    const double x = (static_cast<double>(i % camera.width) + 0.5 - camera.cx) / camera.fx;
    const double y = (static_cast<double>(i / camera.width) + 0.5 - camera.cy) / camera.fy;
    out.inv_depth[i] = static_cast<float>(alpha / depth(x, y));
  }
  return out;
}

TEST(SurfaceOf, FindsDepthAndNormalOfAPlane) {
  const Camera camera = FrontCamera(40, 30);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.4, -1).normalized();
  const auto render =
      RenderOfDepth(camera, 0.8f, [&](double x, double y) { return -2 / normal.dot(Eigen::Vector3d(x, y, 1)); });
  for (const int reach : {1, 3}) {
    const RenderedSurface surface = SurfaceOf(render, camera, reach);
    for (size_t i = 0; i < surface.normals.size(); ++i) {
      ASSERT_NEAR(surface.inv_depth[i] * 0.8f, render.inv_depth[static_cast<int64_t>(i)], 1e-6);
      ASSERT_LT((surface.normals[i].cast<double>() - normal).norm(), 2e-3) << i;
    }
  }
}

TEST(SurfaceOf, KeepsTheNormalsOfBothSidesOfAnEdge) {
  const Camera camera = FrontCamera(40, 30);
  const auto render = RenderOfDepth(camera, 1, [](double x, double) { return x < 0 ? 2 : 4; });
  const RenderedSurface surface = SurfaceOf(render, camera);
  for (const Eigen::Vector3f& normal : surface.normals) {
    ASSERT_LT((normal - Eigen::Vector3f(0, 0, -1)).norm(), 1e-3);
  }
}

TEST(SurfaceOf, ShowsNothingWhereTheRenderIsTransparent) {
  const Camera camera = FrontCamera(8, 6);
  RenderOutput render = RenderOfDepth(camera, 0.4f, [](double, double) { return 2; });
  const RenderedSurface surface = SurfaceOf(render, camera);
  EXPECT_THAT(surface.inv_depth, testing::Each(0.f));
  EXPECT_TRUE(surface.normals[20].isZero());
  render.alpha = Buffer<float>::Zeros({3, 3});
  EXPECT_THROW(SurfaceOf(render, camera), ShapeError);
}

}  // namespace
}  // namespace oraclegs
