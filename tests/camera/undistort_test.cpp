#include "oraclegs/camera/undistort.h"

#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/camera/distortion_models.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

const Intrinsics kBarrel{CameraModel::kOpenCv, 160, 120, {120, 125, 84, 57, -0.2, 0.05, 0.002, -0.001}};
const Intrinsics kPincushion{CameraModel::kSimpleRadial, 160, 120, {120, 80, 60, 0.2}};
const Intrinsics kFisheye{CameraModel::kOpenCvFisheye, 160, 120, {80, 80, 80, 60, 0.02, -0.005, 0, 0}};

/// An image whose pixel at (u, v) is value(u, v).
template <class Value>
ImageF Paint(int width, int height, Value value) {
  ImageF image{width, height, 1, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image.data.push_back(static_cast<float>(value(x + 0.5, y + 0.5)));
  }
  return image;
}

bool Sees(const Intrinsics& intrinsics, const Camera& camera, double x, double y) {
  const auto pixel = Project(intrinsics, (x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy);
  return pixel && pixel->x() >= 0 && pixel->x() <= intrinsics.width && pixel->y() >= 0 &&
         pixel->y() <= intrinsics.height;
}

/// True when the source shows all pixels at the border of the camera's image.
bool SeesBorder(const Intrinsics& intrinsics, const Camera& camera) {
  for (int x = 0; x < camera.width; ++x) {
    if (!Sees(intrinsics, camera, x + 0.5, 0.5) || !Sees(intrinsics, camera, x + 0.5, camera.height - 0.5))
      return false;
  }
  for (int y = 0; y < camera.height; ++y) {
    if (!Sees(intrinsics, camera, 0.5, y + 0.5) || !Sees(intrinsics, camera, camera.width - 0.5, y + 0.5)) return false;
  }
  return true;
}

TEST(UndistortedCamera, KeepsAPinhole) {
  const Camera camera = UndistortedCamera({CameraModel::kOpenCv, 160, 120, {120, 125, 84, 57, 0, 0, 0, 0}});
  EXPECT_EQ(camera.width, 160);
  EXPECT_EQ(camera.height, 120);
  EXPECT_EQ(camera.fx, 120);
  EXPECT_EQ(camera.fy, 125);
  EXPECT_EQ(camera.cx, 84);
  EXPECT_EQ(camera.cy, 57);
}

TEST(UndistortedCamera, IsTheWidestWithoutABlankBorder) {
  for (const Intrinsics& intrinsics : {kBarrel, kPincushion, kFisheye}) {
    const Camera camera = UndistortedCamera(intrinsics);
    EXPECT_EQ(camera.width, intrinsics.width);
    EXPECT_EQ(camera.height, intrinsics.height);
    EXPECT_EQ(camera.cx, intrinsics.cx());
    EXPECT_EQ(camera.cy, intrinsics.cy());
    EXPECT_NEAR(camera.fx / intrinsics.fx(), camera.fy / intrinsics.fy(), 1e-15);
    EXPECT_TRUE(SeesBorder(intrinsics, camera));
    Camera wider = camera;
    wider.fx *= 1 - 1e-9;
    wider.fy *= 1 - 1e-9;
    EXPECT_FALSE(SeesBorder(intrinsics, wider));
  }
  // A barrel's edges bend outwards when undone, so that more is seen; a pincushion's corners reach farther than its
  // edges.
  EXPECT_LT(UndistortedCamera(kBarrel).fx, 120);
  EXPECT_GT(UndistortedCamera(kPincushion).fx, 120);
}

TEST(UndistortedCamera, MatchesTheClosedFormOfOneCoefficient) {
  // A pincushion's middle of the nearer edge decides: pixel center 59.5 from the axis lands on the edge, 60 from it:
  // with r = 59.5 / (120 m), 120 r (1 + 0.2 r^2) = 60.
  const double m = UndistortedCamera(kPincushion).fx / 120;
  const double corner = std::hypot(79.5, 59.5) / (120 * m), side = 79.5 / (120 * m), top = 59.5 / (120 * m);
  const double at_corner = 1 + 0.2 * corner * corner;
  EXPECT_NEAR(std::max(120 * side * at_corner / 80, 120 * top * at_corner / 60), 1, 1e-9);
}

TEST(UndistortedCamera, BoundsTheMagnification) {
  const Intrinsics strong{CameraModel::kSimpleRadial, 160, 120, {120, 80, 60, 1000}};
  EXPECT_DOUBLE_EQ(UndistortedCamera(strong).fx, 600);
  // Nearly a half space is seen: the view is not widened without end.
  const Intrinsics wide{CameraModel::kSimpleRadialFisheye, 160, 120, {40, 80, 60, 0}};
  EXPECT_NEAR(UndistortedCamera(wide).fx, 8, 1e-9);
}

TEST(UndistortedCamera, KeepsTheFocalLengthOfAnAxisOutsideTheImage) {
  EXPECT_EQ(UndistortedCamera({CameraModel::kSimpleRadial, 160, 120, {120, -50, 60, 0.1}}).fx, 120);
  EXPECT_EQ(UndistortedCamera({CameraModel::kSimpleRadial, 160, 120, {120, 80, 121, 0.1}}).fx, 120);
}

TEST(Undistort, CopiesWithoutDistortion) {
  const Intrinsics intrinsics{CameraModel::kSimpleRadial, 160, 120, {120, 80, 60, 0}};
  const ImageF source = Paint(160, 120, [](double u, double v) { return 0.5 + 0.5 * std::sin(u * v); });
  const UndistortedImage result = Undistort(source, intrinsics, UndistortedCamera(intrinsics));
  EXPECT_TRUE(result.valid.empty());
  ASSERT_EQ(result.image.data.size(), source.data.size());
  for (size_t i = 0; i < source.data.size(); ++i) EXPECT_NEAR(result.image.data[i], source.data[i], 1e-5);
}

TEST(Undistort, ShowsEachPixelsRay) {
  // The scene is a linear function of the ray; the distorted image of it, undistorted, must be linear again.
  const auto shade = [](const Eigen::Vector2d& ray) { return 0.5 + 0.3 * ray.x() - 0.2 * ray.y(); };
  for (const Intrinsics& intrinsics : {kBarrel, kPincushion, kFisheye}) {
    const ImageF taken =
        Paint(160, 120, [&](double u, double v) { return shade(Unproject(intrinsics, u, v).value()); });
    const Camera camera = UndistortedCamera(intrinsics);
    const UndistortedImage result = Undistort(taken, intrinsics, camera);
    EXPECT_TRUE(result.valid.empty());
    for (int y = 1; y < 119; ++y) {
      for (int x = 1; x < 159; ++x) {
        const Eigen::Vector2d ray((x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy);
        ASSERT_NEAR(result.image.row(y)[x], shade(ray), 2e-3)
            << CameraModelName(intrinsics.model) << " " << x << ", " << y;
      }
    }
  }
}

TEST(Undistort, StraightensLines) {
  // A dark line through rays with y = 0.2 + 0.1 x, soft by a few pixels.
  const auto darkness = [](const Eigen::Vector2d& ray) {
    const double off = (ray.y() - 0.2 - 0.1 * ray.x()) / 0.02;
    return std::exp(-off * off);
  };
  const ImageF taken = Paint(160, 120, [&](double u, double v) { return darkness(Unproject(kBarrel, u, v).value()); });
  const Camera camera = UndistortedCamera(kBarrel);
  const ImageF straight = Undistort(taken, kBarrel, camera).image;
  for (int x = 10; x < 150; x += 10) {
    double mass = 0, moment = 0;
    for (int y = 0; y < 120; ++y) {
      mass += straight.row(y)[x];
      moment += straight.row(y)[x] * (y + 0.5);
    }
    const double ray_x = (x + 0.5 - camera.cx) / camera.fx;
    EXPECT_NEAR((moment / mass - camera.cy) / camera.fy, 0.2 + 0.1 * ray_x, 2e-4) << x;
  }
}

TEST(Undistort, MarksPixelsOutsideTheSource) {
  const Intrinsics outside{CameraModel::kSimpleRadial, 160, 120, {120, -50, 60, 0.1}};
  const Camera camera = UndistortedCamera(outside);
  const UndistortedImage result = Undistort(Paint(160, 120, [](double, double) { return 0.5; }), outside, camera);
  ASSERT_EQ(result.valid.size(), 160u * 120u);
  int blank = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      const bool valid = result.valid[static_cast<size_t>(160 * y + x)] != 0;
      EXPECT_EQ(valid, Sees(outside, camera, x + 0.5, y + 0.5)) << x << ", " << y;
      blank += !valid;
    }
  }
  EXPECT_GT(blank, 0);
  EXPECT_LT(blank, 160 * 120);
}

TEST(Undistort, LeavesPixelsBeyondTheTurningPointBlank) {
  const Intrinsics intrinsics{CameraModel::kSimpleRadial, 160, 120, {50, 80, 60, -1. / 3}};
  Camera camera{160, 120, 50, 50, 80, 60, Eigen::Isometry3d::Identity()};
  const UndistortedImage result = Undistort(Paint(160, 120, [](double, double) { return 1.; }), intrinsics, camera);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      const bool near_axis = std::hypot(x + 0.5 - 80, y + 0.5 - 60) < 50;
      EXPECT_EQ(result.valid[static_cast<size_t>(160 * y + x)] != 0, near_axis);
      EXPECT_EQ(result.image.row(y)[x], near_axis ? 1.f : 0.f);
    }
  }
}

TEST(Undistort, GivesTheSameForAnyChannelAndThreadCount) {
  const ImageF one = Paint(160, 120, [](double u, double v) { return std::sin(u) * std::cos(v); });
  ImageF five{160, 120, 5, {}};
  for (const float value : one.data) five.data.insert(five.data.end(), 5, value);
  SetNumThreads(1);
  const ImageF a = Undistort(one, kBarrel, UndistortedCamera(kBarrel)).image;
  SetNumThreads(4);
  const ImageF b = Undistort(five, kBarrel, UndistortedCamera(kBarrel)).image;
  SetNumThreads(0);
  for (size_t i = 0; i < a.data.size(); ++i) ASSERT_EQ(a.data[i], b.data[5 * i + 3]);
}

TEST(Undistort, RefusesAnImageOfAnotherSize) {
  EXPECT_THROW(Undistort(Paint(10, 10, [](double, double) { return 0.; }), kBarrel, UndistortedCamera(kBarrel)),
               ShapeError);
}

}  // namespace
}  // namespace oraclegs
