#include "oraclegs/depth/continued_planes.h"

#include <gtest/gtest.h>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr int kAcross = 96, kDown = 64;
const Eigen::Vector3f kGreen(0.3f, 0.6f, 0.1f), kWhite(0.9f, 0.9f, 0.85f);

/// Inverse depths of a wall and of the ground before it, at the center of a pixel.
float Wall(int x, int y) { return 0.2f + 0.0005f * (static_cast<float>(x) + 0.5f) + 0 * static_cast<float>(y); }
float Ground(int, int y) { return 0.01f * (static_cast<float>(y) + 0.5f); }

/// A white wall above green ground; the depth of both is known, but for a part of the ground in the corner of the
/// image.
class ContinuedPlanesTest : public testing::Test {
 protected:
  void SetUp() override {
    map.camera.width = kAcross, map.camera.height = kDown;
    rgb = ImageF{kAcross, kDown, 3, std::vector<float>(size_t{3} * kAcross * kDown)};
    for (int y = 0; y < kDown; ++y) {
      for (int x = 0; x < kAcross; ++x) {
        const bool is_wall = y < 24;
        Paint(x, y, is_wall ? kWhite : kGreen);
        map.inv_depth.push_back(is_wall ? Wall(x, y) : Ground(x, y));
        map.confidence.push_back(0.9f);
      }
    }
    Forget(60, 24, kAcross, kDown);
  }
  void Paint(int x, int y, const Eigen::Vector3f& color) {
    for (int c = 0; c < 3; ++c) rgb.row(y)[3 * x + c] = color[c];
  }
  void Forget(int left, int top, int right, int bottom) {
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) map.confidence[static_cast<size_t>(y * kAcross + x)] = 0;
    }
  }
  ContinuedPlanes Planes() const {
    return ContinuedPlanes(map, rgb, kConfident, [](size_t) { return true; });
  }

  DepthMap map;
  ImageF rgb;
};

TEST_F(ContinuedPlanesTest, ContinueWhatHasTheColor) {
  const ContinuedPlanes planes = Planes();
  for (const auto& [x, y] : {std::pair(62, 26), std::pair(80, 30), std::pair(75, 60)}) {
    const std::optional<Plane> plane = planes.At(x, y);
    ASSERT_TRUE(plane) << x << ", " << y;
    EXPECT_NEAR(plane->inv_depth, Ground(x, y), 1e-4) << "right below the wall, and far from known ground";
    EXPECT_NEAR(plane->dx, 0, 1e-5);
    EXPECT_NEAR(plane->dy, 0.01, 1e-5);
  }
}

TEST_F(ContinuedPlanesTest, ContinueNothingOfAnotherColor) {
  for (int y = 24; y < kDown; ++y) {
    for (int x = 60; x < kAcross; ++x) Paint(x, y, {0.1f, 0.1f, 0.9f});
  }
  EXPECT_FALSE(Planes().At(80, 40));
}

TEST_F(ContinuedPlanesTest, ContinueNothingThatIsAtOdds) {
  for (size_t i = 0; i < map.size(); ++i) {  // leaves, each at a distance of its own
    map.inv_depth[i] = 0.1f + 0.01f * static_cast<float>(i * 2654435761u % 97);
  }
  EXPECT_FALSE(Planes().At(80, 40));
}

TEST_F(ContinuedPlanesTest, StayWithinTwiceTheKnownRange) {
  Forget(0, 24, kAcross, kDown);
  for (int y = 24; y < 30; ++y) {
    for (int x = 0; x < kAcross; ++x) map.confidence[static_cast<size_t>(y * kAcross + x)] = 0.9f;
  }
  for (int y = 0; y < kDown; ++y) {
    for (int x = 0; x < kAcross; ++x) map.inv_depth[static_cast<size_t>(y * kAcross + x)] = Ground(x, y);
  }
  Forget(0, 0, kAcross, 24);
  const ContinuedPlanes planes = Planes();
  EXPECT_TRUE(planes.At(50, 40));
  EXPECT_FALSE(planes.At(50, 62)) << "0.625, where 0.295 is the nearest that is known";
  EXPECT_FALSE(planes.At(50, 8)) << "another color; and farther than half of 0.245";
}

TEST_F(ContinuedPlanesTest, LeaveOutWhatMayNotBeFilled) {
  const ContinuedPlanes planes(map, rgb, kConfident, [](size_t i) { return i % kAcross < 80; });
  EXPECT_TRUE(planes.At(70, 40));
  EXPECT_FALSE(planes.At(90, 40));
}

TEST_F(ContinuedPlanesTest, AreTheSameForAnyThreads) {
  const ContinuedPlanes before = Planes();
  SetNumThreads(1);
  const ContinuedPlanes after = Planes();
  SetNumThreads(0);
  for (int y = 24; y < kDown; ++y) {
    for (int x = 60; x < kAcross; ++x) {
      ASSERT_EQ(before.At(x, y).has_value(), after.At(x, y).has_value());
      if (!before.At(x, y)) continue;
      EXPECT_EQ(before.At(x, y)->inv_depth, after.At(x, y)->inv_depth);
    }
  }
}

}  // namespace
}  // namespace oraclegs
