#include "oraclegs/camera/camera.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "support/errors.h"

namespace oraclegs {
namespace {

using ::testing::HasSubstr;

Camera SomeCamera() {
  Camera camera{640, 480, 500, 510, 320, 240, Eigen::Isometry3d::Identity()};
  camera.cam_from_world.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  camera.cam_from_world.translation() = Eigen::Vector3d(0.5, -1, 2);
  return camera;
}

TEST(Camera, MapsItsCenterToTheOrigin) {
  const Camera camera = SomeCamera();
  EXPECT_LT((camera.cam_from_world * camera.Center()).norm(), 1e-14);
  EXPECT_LT((camera.cam_from_world.linear() * camera.Forward() - Eigen::Vector3d::UnitZ()).norm(), 1e-14);
}

TEST(Camera, CheckNamesTheFault) {
  EXPECT_NO_THROW(SomeCamera().Check("a.png"));
  const auto message = [](auto change) {
    Camera camera = SomeCamera();
    change(&camera);
    return MessageOf<InputError>([&] { camera.Check("a.png"); });
  };
  EXPECT_THAT(message([](Camera* c) { c->width = 0; }), HasSubstr("a.png: the image size is 0 x 480"));
  EXPECT_THAT(message([](Camera* c) { c->fy = 0; }), HasSubstr("focal length is 500 x 0"));
  EXPECT_THAT(message([](Camera* c) { c->fx = -3; }), HasSubstr("must be positive"));
  EXPECT_THAT(message([](Camera* c) { c->cx = std::nan(""); }), HasSubstr("finite"));
  EXPECT_THAT(message([](Camera* c) { c->cam_from_world.translation().x() = std::numeric_limits<double>::infinity(); }),
              HasSubstr("not finite"));
  EXPECT_THAT(message([](Camera* c) { c->cam_from_world.linear() *= 1.01; }), HasSubstr("not a rotation"));
  EXPECT_THAT(message([](Camera* c) { c->cam_from_world.linear().row(0) *= -1; }), HasSubstr("not a rotation"));
}

TEST(Camera, ResizesWithTheSameRays) {
  const Camera camera = SomeCamera();
  const Camera small = Resized(camera, 160, 96);
  EXPECT_EQ(small.width, 160);
  EXPECT_EQ(small.height, 96);
  EXPECT_TRUE(small.cam_from_world.isApprox(camera.cam_from_world));
  // The image's corner stays its corner, since pixels are areas: (640, 480) becomes (160, 96).
  for (const double share : {0., 0.3, 1.}) {
    EXPECT_NEAR((share * 640 - camera.cx) / camera.fx, (share * 160 - small.cx) / small.fx, 1e-15);
    EXPECT_NEAR((share * 480 - camera.cy) / camera.fy, (share * 96 - small.cy) / small.fy, 1e-15);
  }
}

TEST(TurnBetween, IsTheAngle) {
  Camera a, b;
  for (const double angle : {0., 1e-7, 0.3, 2., std::numbers::pi}) {
    b.cam_from_world.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    EXPECT_NEAR(TurnBetween(a, b), angle, 1e-7) << angle;
  }
}

}  // namespace
}  // namespace oraclegs
