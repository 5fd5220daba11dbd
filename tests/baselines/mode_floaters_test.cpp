#include "oraclegs/baselines/mode_floaters.h"

#include <cmath>

#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

/// Looks along z, 48 x 48 pixels.
Camera Square() { return {48, 48, 48, 48, 24, 24, Eigen::Isometry3d::Identity()}; }

/// A wall at z = 8 of 24 x 24 opaque Gaussians, and last in the list a floater before it, at z = 2, which covers about
/// 4 x 4 pixels.
Gaussians WallAndFloater(float opacity) {
  constexpr int kSide = 24;
  Gaussians g = RandomGaussians(kSide * kSide + 1, 1);
  for (int i = 0; i <= kSide * kSide; ++i) {
    const bool wall = i < kSide * kSide;
    const float step = 8.f / kSide;
    const float mean[3] = {wall ? -4 + step * (static_cast<float>(i % kSide) + 0.5f) : 0.3f,
                           wall ? -4 + step * (static_cast<float>(i / kSide) + 0.5f) : 0.2f, wall ? 8.f : 2.f};
    std::copy(mean, mean + 3, g.means.data() + 3 * i);
    std::fill_n(g.log_scales.data() + 3 * i, 3, std::log(wall ? 0.25f : 0.05f));
    g.opacity_logits[i] = wall ? 3.f : std::log(opacity / (1 - opacity));
  }
  return g;
}

TEST(ModeDifferences, AreRelative) {
  RayModes modes;
  modes.blended_depth = {4, 4, 4, 4, 4, 4, 4, 4, 4, 0};
  modes.mode_depth = {4, 3, 5, 4, 4, 4, 4, 4, 4, 0};
  // Mean 3.6, deviation 1.265: mean - 3 deviations is below 0, the least depth.
  const std::vector<float> differences = ModeDifferences(modes);
  EXPECT_EQ(differences, (std::vector<float>{0, 0.25f, -0.25f, 0, 0, 0, 0, 0, 0, 0}));
  modes.blended_depth.back() = 4;
  EXPECT_EQ(ModeDifferences(modes)[1], 0.125f);  // (4 - 3) / (4 + 4)
}

TEST(FloaterPercentile, FallsWithTheDip) {
  const ModeFloaterOptions options;
  EXPECT_EQ(FloaterPercentile(0, options), 98);
  EXPECT_NEAR(FloaterPercentile(0.01, options), 98 * std::exp(-0.075), 1e-12);
  EXPECT_EQ(FloaterPercentile(0.2, options), 80);
}

TEST(FindModeFloaters, FindsWhatHangsBeforeTheWall) {
  const Gaussians g = WallAndFloater(0.6f);
  const std::vector<uint8_t> floaters = FindModeFloaters(g, {Square()}, {}, {});
  ASSERT_EQ(floaters.size(), 577U);
  EXPECT_EQ(floaters.back(), 1);
  EXPECT_EQ(std::count(floaters.begin(), floaters.end(), 1), 1);
}

TEST(FindModeFloaters, SparesWhatIsNoMode) {
  // Of weight below that of the wall behind it: it is not the mode of any pixel.
  const std::vector<uint8_t> floaters = FindModeFloaters(WallAndFloater(0.2f), {Square()}, {}, {});
  EXPECT_EQ(floaters.back(), 0);
}

TEST(FindModeFloaters, JoinsViewsForAnyNumberOfThreads) {
  Gaussians g = RandomGaussians(2000, 4);
  Table(g.means).col(2) += 6;
  Camera right = Square();
  right.cam_from_world.translation().x() = -1;
  const auto run = [&](const std::vector<Camera>& cameras, int threads) {
    const Threads scope(threads);
    return FindModeFloaters(g, cameras, {}, {});
  };
  const auto both = run({Square(), right}, 1);
  EXPECT_EQ(run({Square(), right}, 3), both);
  EXPECT_GT(std::count(both.begin(), both.end(), 1), 10);
  EXPECT_LT(std::count(both.begin(), both.end(), 1), 1500);
  EXPECT_EQ(run({}, 1), std::vector<uint8_t>(2000, 0));
}

}  // namespace
}  // namespace oraclegs
