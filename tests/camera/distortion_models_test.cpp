#include "oraclegs/camera/distortion_models.h"

#include <gtest/gtest.h>

#include <cmath>

namespace oraclegs {
namespace {

constexpr double kF = 500, kCx = 320, kCy = 240;

/// One of each model, as strongly distorted as real ones.
std::vector<Intrinsics> OneOfEach() {
  return {
      {CameraModel::kSimplePinhole, 640, 480, {kF, kCx, kCy}},
      {CameraModel::kPinhole, 640, 480, {kF, 510, kCx, kCy}},
      {CameraModel::kSimpleRadial, 640, 480, {kF, kCx, kCy, -0.15}},
      {CameraModel::kRadial, 640, 480, {kF, kCx, kCy, -0.25, 0.08}},
      {CameraModel::kOpenCv, 640, 480, {kF, 510, kCx, kCy, -0.25, 0.08, 0.002, -0.003}},
      {CameraModel::kOpenCvFisheye, 640, 480, {300, 310, kCx, kCy, 0.05, -0.01, 0.002, -0.0005}},
      {CameraModel::kFullOpenCv, 640, 480, {kF, 510, kCx, kCy, 0.1, 0.05, 0.001, -0.002, 0.01, 0.3, 0.1, 0.02}},
      {CameraModel::kFov, 640, 480, {kF, 510, kCx, kCy, 0.9}},
      {CameraModel::kSimpleRadialFisheye, 640, 480, {300, kCx, kCy, 0.05}},
      {CameraModel::kRadialFisheye, 640, 480, {300, kCx, kCy, 0.05, -0.01}},
      {CameraModel::kThinPrismFisheye,
       640,
       480,
       {300, 310, kCx, kCy, 0.05, -0.01, 0.001, -0.002, 0.002, 0, 0.003, -0.001}},
  };
}

class EveryCameraModel : public testing::TestWithParam<int> {};

TEST_P(EveryCameraModel, UnprojectsEveryPixel) {
  const Intrinsics intrinsics = OneOfEach()[static_cast<size_t>(GetParam())];
  intrinsics.Check("camera");
  const DistortionMap map(intrinsics);
  int seen = 0;
  for (double py = 0; py <= 480; py += 24) {
    for (double px = 0; px <= 640; px += 32) {
      const auto ray = map.Unproject(px, py);
      ASSERT_TRUE(ray.has_value()) << px << ", " << py;
      const auto pixel = Project(intrinsics, ray->x(), ray->y());
      ASSERT_TRUE(pixel.has_value()) << px << ", " << py;
      EXPECT_NEAR(pixel->x(), px, 1e-7);
      EXPECT_NEAR(pixel->y(), py, 1e-7);
      ++seen;
    }
  }
  EXPECT_EQ(seen, 21 * 21);
}

TEST_P(EveryCameraModel, ProjectsEveryRay) {
  const Intrinsics intrinsics = OneOfEach()[static_cast<size_t>(GetParam())];
  for (double y = -0.5; y <= 0.5; y += 0.1) {
    for (double x = -0.6; x <= 0.6; x += 0.1) {
      const auto pixel = Project(intrinsics, x, y);
      ASSERT_TRUE(pixel.has_value()) << x << ", " << y;
      const auto ray = Unproject(intrinsics, pixel->x(), pixel->y());
      ASSERT_TRUE(ray.has_value()) << x << ", " << y;
      EXPECT_NEAR(ray->x(), x, 1e-9);
      EXPECT_NEAR(ray->y(), y, 1e-9);
    }
  }
}

TEST_P(EveryCameraModel, MapsTheAxisToThePrincipalPoint) {
  const Intrinsics intrinsics = OneOfEach()[static_cast<size_t>(GetParam())];
  EXPECT_EQ(Project(intrinsics, 0, 0).value(), Eigen::Vector2d(kCx, kCy));
  EXPECT_LT(Unproject(intrinsics, kCx, kCy).value().norm(), 1e-15);
}

TEST_P(EveryCameraModel, RefusesNonFiniteInput) {
  const Intrinsics intrinsics = OneOfEach()[static_cast<size_t>(GetParam())];
  EXPECT_FALSE(Project(intrinsics, std::nan(""), 0).has_value());
  EXPECT_FALSE(Unproject(intrinsics, 0, std::nan("")).has_value());
  EXPECT_FALSE(Unproject(intrinsics, HUGE_VAL, 0).has_value());
}

TEST_P(EveryCameraModel, SeesDirectionsBesideAndBehindItWhereItIsAFisheye) {
  const Intrinsics intrinsics = OneOfEach()[static_cast<size_t>(GetParam())];
  const DistortionMap map(intrinsics);
  const double end = map.EndOfFisheye();
  double px = 0, py = 0;
  if (end == 0) {
    EXPECT_FALSE(map.ProjectDirection({0, 0, 1}, &px, &py));
    EXPECT_FALSE(map.UnprojectDirection(kCx, kCy).has_value());
    return;
  }
  EXPECT_GT(end, 1.6) << "the models here turn back late";
  for (double angle = 0; angle < .9 * end; angle += .05) {
    for (double turn = 0; turn < 6.28; turn += .3) {
      const Eigen::Vector3d direction(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn),
                                      std::cos(angle));
      ASSERT_TRUE(map.ProjectDirection(7 * direction, &px, &py)) << angle << " " << turn;
      const auto back = map.UnprojectDirection(px, py);
      ASSERT_TRUE(back.has_value()) << angle << " " << turn;
      EXPECT_LT((*back - direction).norm(), 1e-9) << angle << " " << turn;
      double px_back = 0, py_back = 0;
      ASSERT_TRUE(map.ProjectDirection(*back, &px_back, &py_back));
      EXPECT_LT(std::hypot(px_back - px, py_back - py), 1e-7);
      if (direction.z() < .02) continue;
      const auto flat = Project(intrinsics, direction.x() / direction.z(), direction.y() / direction.z());
      ASSERT_TRUE(flat.has_value());
      EXPECT_NEAR(flat->x(), px, 1e-9) << "as the ray is";
      EXPECT_NEAR(flat->y(), py, 1e-9);
    }
  }
  const double beyond = 1.01 * end;
  EXPECT_FALSE(map.ProjectDirection({std::sin(beyond), 0, std::cos(beyond)}, &px, &py) && end < 3);
  EXPECT_FALSE(map.ProjectDirection({0, 0, -1}, &px, &py));
  EXPECT_FALSE(map.UnprojectDirection(std::nan(""), 0).has_value());
}

INSTANTIATE_TEST_SUITE_P(Models, EveryCameraModel, testing::Range(0, 11), [](const auto& info) {
  return std::string(CameraModelName(static_cast<CameraModel>(info.param)));
});

/// The distorted plane coordinates that the model's published formula gives for x = 0.3, y = -0.4 (r = 1/2).
TEST(Project, FollowsThePublishedFormulas) {
  const auto plane = [](CameraModel model, std::vector<double> coefficients) {
    const bool one = model == CameraModel::kSimpleRadial || model == CameraModel::kRadial ||
                     model == CameraModel::kSimpleRadialFisheye || model == CameraModel::kRadialFisheye;
    Intrinsics intrinsics{model, 2, 2, one ? std::vector<double>{1, 0, 0} : std::vector<double>{1, 1, 0, 0}};
    intrinsics.params.insert(intrinsics.params.end(), coefficients.begin(), coefficients.end());
    return Project(intrinsics, 0.3, -0.4).value();
  };
  const auto expect = [](const Eigen::Vector2d& got, double u, double v) {
    EXPECT_NEAR(got.x(), u, 1e-15);
    EXPECT_NEAR(got.y(), v, 1e-15);
  };
  const double r2 = 0.25, r4 = r2 * r2, r6 = r4 * r2;
  expect(plane(CameraModel::kSimpleRadial, {0.2}), 0.3 * (1 + 0.2 * r2), -0.4 * (1 + 0.2 * r2));
  expect(plane(CameraModel::kRadial, {0.2, 0.1}), 0.3 * (1 + 0.2 * r2 + 0.1 * r4), -0.4 * (1 + 0.2 * r2 + 0.1 * r4));
  const double k = 1 + 0.2 * r2 + 0.1 * r4;
  const double p1 = 0.01, p2 = 0.02, xy = -0.12, xx = 0.09, yy = 0.16;
  const double tx = 2 * p1 * xy + p2 * (r2 + 2 * xx), ty = 2 * p2 * xy + p1 * (r2 + 2 * yy);
  expect(plane(CameraModel::kOpenCv, {0.2, 0.1, p1, p2}), 0.3 * k + tx, -0.4 * k + ty);
  const double rational = (k + 0.3 * r6) / (1 + 0.4 * r2 + 0.5 * r4 + 0.6 * r6);
  expect(plane(CameraModel::kFullOpenCv, {0.2, 0.1, p1, p2, 0.3, 0.4, 0.5, 0.6}), 0.3 * rational + tx,
         -0.4 * rational + ty);
  const double fov = std::atan(2 * 0.5 * std::tan(0.45)) / 0.9 / 0.5;
  expect(plane(CameraModel::kFov, {0.9}), 0.3 * fov, -0.4 * fov);
  const double t = std::atan(0.5), t2 = t * t, s = t / 0.5;
  expect(plane(CameraModel::kSimpleRadialFisheye, {0.2}), 0.3 * s * (1 + 0.2 * t2), -0.4 * s * (1 + 0.2 * t2));
  const double kt = 1 + 0.2 * t2 + 0.1 * t2 * t2;
  expect(plane(CameraModel::kRadialFisheye, {0.2, 0.1}), 0.3 * s * kt, -0.4 * s * kt);
  const double k4 = kt + 0.3 * std::pow(t, 6) + 0.4 * std::pow(t, 8);
  expect(plane(CameraModel::kOpenCvFisheye, {0.2, 0.1, 0.3, 0.4}), 0.3 * s * k4, -0.4 * s * k4);
  const double a = 0.3 * s, b = -0.4 * s;
  expect(plane(CameraModel::kThinPrismFisheye, {0.2, 0.1, p1, p2, 0.3, 0.4, 0.05, 0.06}),
         a * k4 + 2 * p1 * a * b + p2 * (t2 + 2 * a * a) + 0.05 * t2,
         b * k4 + 2 * p2 * a * b + p1 * (t2 + 2 * b * b) + 0.06 * t2);
}

TEST(Project, FovIsAPinholeInTheLimit) {
  const auto x = [](double omega) {
    return Project(Intrinsics{CameraModel::kFov, 2, 2, {1, 1, 0, 0, omega}}, 0.5, 0).value().x();
  };
  EXPECT_EQ(x(0), 0.5);
  EXPECT_NEAR(x(1e-7), 0.5, 1e-14);
  EXPECT_NEAR(x(0.01), 0.5 * (1 + 1e-4 / 12 - 1e-4 * 0.25 / 3), 1e-9);
  EXPECT_EQ(x(0.7), x(-0.7));
  EXPECT_FALSE((Project(Intrinsics{CameraModel::kFov, 2, 2, {1, 1, 0, 0, 3.2}}, 0.5, 0).has_value()));
}

TEST(Project, StopsAtTheTurningPoint) {
  // r (1 - k r^2) turns at r = 1 / sqrt(3 k), here 1, where it is 2/3.
  const Intrinsics intrinsics{CameraModel::kSimpleRadial, 1000, 1000, {500, 500, 500, -1. / 3}};
  EXPECT_NEAR(Project(intrinsics, 1 - 1e-9, 0).value().x(), 500 + 500 * 2. / 3, 1e-6);
  EXPECT_FALSE(Project(intrinsics, 1 + 1e-9, 0).has_value());
  EXPECT_FALSE(Project(intrinsics, 0.8, 0.8).has_value());
  EXPECT_FALSE(Project(intrinsics, 30, 0).has_value());
  EXPECT_NEAR(Unproject(intrinsics, 500 + 333.3, 500).value().x(), 0.98, 0.02);
  EXPECT_FALSE(Unproject(intrinsics, 500 + 333.4, 500).has_value());
}

TEST(Project, StopsAtTheFirstOfTwoTurningPoints) {
  // The derivative 1 + 3 k1 s + 5 k2 s^2 = (1 - s)(1 - s / 4) is zero at s = 1 and again at s = 4.
  const Intrinsics intrinsics{CameraModel::kRadial, 1000, 1000, {500, 500, 500, -1.25 / 3, 0.25 / 5}};
  EXPECT_TRUE(Project(intrinsics, 0.999999, 0).has_value());
  EXPECT_FALSE(Project(intrinsics, 1.000001, 0).has_value());
  EXPECT_FALSE(Project(intrinsics, 5, 0).has_value());
}

TEST(Project, StopsBeforeThePoleOfARationalModel) {
  // R = 1 / (1 - s): grows without bound towards s = 1.
  const Intrinsics intrinsics{CameraModel::kFullOpenCv, 1000, 1000, {500, 500, 500, 500, 0, 0, 0, 0, 0, -1, 0, 0}};
  EXPECT_NEAR(Project(intrinsics, 0.5, 0).value().x(), 500 + 500 * 0.5 / 0.75, 1e-9);
  EXPECT_FALSE(Project(intrinsics, 1, 0).has_value());
  EXPECT_FALSE(Project(intrinsics, 2, 0).has_value());
  EXPECT_NEAR(Unproject(intrinsics, 500 + 500 * 0.5 / 0.75, 500).value().x(), 0.5, 1e-12);
}

TEST(Project, StopsWhereTangentialTermsFoldTheImage) {
  const Intrinsics intrinsics{CameraModel::kOpenCv, 1000, 1000, {500, 500, 500, 500, 0, 0, 0, 0.2}};
  // u = x + 3 p2 x^2 along y = 0 turns at x = -1 / (6 p2).
  EXPECT_TRUE(Project(intrinsics, -0.83, 0).has_value());
  EXPECT_FALSE(Project(intrinsics, -0.84, 0).has_value());
}

TEST(Project, FisheyeReachesAlmostAHalfSpace) {
  const Intrinsics intrinsics{CameraModel::kOpenCvFisheye, 1000, 1000, {300, 300, 500, 500, 0, 0, 0, 0}};
  const double angle = 89.9 * M_PI / 180;
  EXPECT_NEAR(Project(intrinsics, std::tan(angle), 0).value().x(), 500 + 300 * angle, 1e-7);
  EXPECT_NEAR(std::atan(Unproject(intrinsics, 500 + 300 * angle, 500).value().x()), angle, 1e-12);
  EXPECT_FALSE(Unproject(intrinsics, 500 + 300 * 1.58, 500).has_value());
}

}  // namespace
}  // namespace oraclegs
