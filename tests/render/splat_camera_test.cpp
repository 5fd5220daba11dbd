#include "oraclegs/render/splat_camera.h"

#include <gtest/gtest.h>

#include "render/scenes.h"

namespace oraclegs {
namespace {

TEST(MakeSplatCamera, ClampsFifteenPercentOutsideTheImage) {
  const Camera camera = FrontCamera(70, 33);
  const SplatCamera<double> c = MakeSplatCamera<double>(camera, {});
  EXPECT_NEAR(camera.fx * c.min_u + camera.cx, -0.15 * 70, 1e-5);
  EXPECT_NEAR(camera.fx * c.max_u + camera.cx, 1.15 * 70, 1e-5);
  EXPECT_NEAR(camera.fy * c.min_v + camera.cy, -0.15 * 33, 1e-5);
  EXPECT_NEAR(camera.fy * c.max_v + camera.cy, 1.15 * 33, 1e-5);
}

TEST(MakeSplatCamera, HoldsTheCameraAndTheOptions) {
  Camera camera = FrontCamera(33, 16);
  camera.cam_from_world.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  camera.cam_from_world.translation() = Eigen::Vector3d(4, -5, 6);
  const SplatCamera<float> c = MakeSplatCamera<float>(camera, {{0.1f, 0.2f, 0.3f}, 2, true});
  const Eigen::Vector3d eye = camera.Center();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      EXPECT_EQ(c.r[3 * i + j], static_cast<float>(camera.cam_from_world.linear()(i, j)));
    }
    EXPECT_EQ(c.t[i], static_cast<float>(camera.cam_from_world.translation()[i]));
    EXPECT_EQ(c.eye[i], static_cast<float>(eye[i]));
    EXPECT_EQ(c.background[i], 0.1f * static_cast<float>(i + 1));
  }
  EXPECT_EQ(c.fx, static_cast<float>(camera.fx));
  EXPECT_EQ(c.cy, static_cast<float>(camera.cy));
  EXPECT_EQ(c.tiles_x, 3);
  EXPECT_EQ(c.tiles_y, 1);
  EXPECT_EQ(c.tiles(), 3);
  EXPECT_EQ(c.sh_degree, 2);
  EXPECT_TRUE(c.antialiased);
}

}  // namespace
}  // namespace oraclegs
