#include "oraclegs/camera/fisheye_lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace oraclegs {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// A lens of so many pixels a radian.
Intrinsics Fisheye(double focal, int width, int height, double k1 = 0) {
  return {CameraModel::kOpenCvFisheye, width, height, {focal, focal, width / 2., height / 2., k1, 0, 0, 0}};
}

/// Bright up to a distance from the middle, and almost black beyond; there an alpha channel is 0.
Image8 Circle(int side, double radius, int channels = 3) {
  Image8 image{side, side, channels, {}};
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const bool lit = std::hypot(x + .5 - side / 2., y + .5 - side / 2.) < radius;
      for (int c = 0; c < channels; ++c) image.data.push_back(lit ? 200 : c == 3 ? 0 : 9);
    }
  }
  return image;
}

TEST(WideFisheye, ReachesToTheFarthestCorner) {
  const auto lens = WideFisheye(Fisheye(100, 300, 400));
  ASSERT_TRUE(lens);
  EXPECT_NEAR(lens->reach, 2.5, 1e-9) << "150 by 200 pixels";
  EXPECT_EQ(lens->intrinsics.params[0], 100);
  EXPECT_TRUE(WideFisheye(Fisheye(250 / (80.1 * kDegree), 300, 400)));
  EXPECT_FALSE(WideFisheye(Fisheye(250 / (79.9 * kDegree), 300, 400)));
}

TEST(WideFisheye, EndsWhereTheModelTurnsBack) {
  const auto lens = WideFisheye(Fisheye(100, 600, 600, -.15));  // theta (1 + k theta^2) has its top at 1 / sqrt(-3 k)
  ASSERT_TRUE(lens);
  EXPECT_NEAR(lens->reach, 1 / std::sqrt(.45), 1e-9);
  EXPECT_FALSE(WideFisheye(Fisheye(100, 600, 600, -.3))) << "at 60 degrees";
  EXPECT_NEAR(WideFisheye(Fisheye(100, 2000, 2000))->reach, std::numbers::pi, 1e-12) << "nothing is farther";
}

TEST(WideFisheye, IsNoOtherCamera) {
  EXPECT_FALSE(WideFisheye({CameraModel::kPinhole, 4000, 4000, {10, 10, 2000, 2000}}));
  EXPECT_FALSE(WideFisheye({CameraModel::kFov, 400, 400, {100, 100, 200, 200, 1.5}}));
}

TEST(LightReach, EndsAtTheCircle) {
  const FisheyeLens lens = WideFisheye(Fisheye(100, 400, 400)).value();
  for (const int channels : {3, 4}) {
    EXPECT_NEAR(LightReach(Circle(400, 166, channels), lens), 1.66, .02) << channels;
  }
  EXPECT_EQ(LightReach(Circle(400, 400), lens), lens.reach);
  EXPECT_EQ(LightReach(Circle(400, 0), lens), 0);
  Image8 flare = Circle(400, 166);
  for (int y = 30; y < 34; ++y) std::fill_n(flare.data.begin() + 3 * (400 * y + 30), 3 * 8, uint8_t{255});
  EXPECT_NEAR(LightReach(flare, lens), 1.66, .02) << "a flare in a corner";
}

TEST(LightReach, IsOfTheLightOnOneSide) {
  const FisheyeLens lens = WideFisheye(Fisheye(100, 400, 400)).value();
  Image8 night = Circle(400, 166);
  std::fill_n(night.data.begin(), 3 * 400 * 280, uint8_t{0});  // a black sky: the ground is lit
  EXPECT_NEAR(LightReach(night, lens), 1.66, .02);
}

}  // namespace
}  // namespace oraclegs
