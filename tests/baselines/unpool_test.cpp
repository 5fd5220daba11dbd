#include "oraclegs/baselines/unpool.h"

#include <cmath>

#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

/// A tight group of four at the origin, and one at (x, 0, 0) whose three nearest are of the group.
struct Isolated {
  Gaussians gaussians = RandomGaussians(5, 1);

  explicit Isolated(float x) {
    const std::vector<float> means = {0, 0, 0, 1, 0, 0, 0.5f, 0.25f, 0, -9, 0, 0, x, 0, 0};
    std::copy(means.begin(), means.end(), gaussians.means.data());
  }
  int64_t Unpool(const ProximityLimits& limits, int64_t most = 100) {
    return UnpoolGaussians(limits, most, &gaussians);
  }
};

/// Mean squared distances: 240.4 for the one at x = 16, 90.4 for the one at -9, less than 34 for the others.
ProximityLimits Above(double threshold) { return {threshold, 0}; }

TEST(IsolatedGaussians, AreLargeAndFarFromTheOthers) {
  Isolated scene(16);
  const auto set_scale = [&](int64_t row, float scale) {
    std::fill_n(scene.gaussians.log_scales.data() + 3 * row, 3, std::log(scale));
  };
  for (int64_t row = 0; row < 5; ++row) set_scale(row, 2);
  EXPECT_EQ(IsolatedGaussians({80, 1}, scene.gaussians), (std::vector<int64_t>{4, 3})) << "the loneliest first";
  EXPECT_EQ(IsolatedGaussians({100, 1}, scene.gaussians), (std::vector<int64_t>{4}));
  set_scale(4, 0.5f);
  EXPECT_EQ(IsolatedGaussians({80, 1}, scene.gaussians), (std::vector<int64_t>{3}));
  EXPECT_TRUE(IsolatedGaussians({80, 3}, scene.gaussians).empty());
}

TEST(UnpoolGaussians, AddsTheMiddleOfEachEdge) {
  Isolated scene(16);
  const Gaussians before = scene.gaussians.Clone();
  ASSERT_EQ(scene.Unpool(Above(144)), 3);
  const Gaussians& g = scene.gaussians;
  ASSERT_EQ(g.size(), 8);
  const std::vector<int64_t> destinations = {1, 2, 0};  // the nearest first
  const std::vector<std::array<float, 3>> middles = {{8.5f, 0, 0}, {8.25f, 0.125f, 0}, {8, 0, 0}};
  for (int64_t k = 0; k < 3; ++k) {
    for (int64_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(g.means[3 * (5 + k) + axis], middles[k][axis]);
      EXPECT_EQ(g.log_scales[3 * (5 + k) + axis], before.log_scales[3 * destinations[k] + axis]);
    }
    EXPECT_EQ(g.opacity_logits[5 + k], before.opacity_logits[destinations[k]]);
    EXPECT_TRUE(Equal(g.quats.Rows(5 + k, 6 + k), Buffer<float>::From({1, 4}, {1, 0, 0, 0})));
    EXPECT_EQ(MaxAbs(g.sh.Rows(5 + k, 6 + k)), 0);
  }
}

TEST(UnpoolGaussians, LeavesTheOthers) {
  Isolated scene(16);
  const Isolated before(16);
  scene.Unpool(Above(144));
  const auto a = Tensors(scene.gaussians), b = Tensors(before.gaussians);
  for (size_t t = 0; t < a.size(); ++t) EXPECT_TRUE(SameBytes(a[t].Rows(0, 5), b[t]));
}

TEST(UnpoolGaussians, ComparesTheScoreAndSize) {
  const auto added = [](double extent, float log_scale) {
    Isolated scene(16);
    Flat(scene.gaussians.log_scales).setConstant(-20);
    scene.gaussians.log_scales[3 * 4 + 1] = log_scale;
    return scene.Unpool(ProximityLimits::Unpool(extent));
  };
  const float just_above = std::log(48.0f * 1.001f), below = std::log(47.0f);
  EXPECT_EQ(added(48.0, just_above), 3);
  EXPECT_EQ(added(48.0, below), 0);  // too small
  EXPECT_EQ(added(48.1, 10.f), 0);   // too near: 5 * 48.1 = 240.5
}

TEST(UnpoolGaussians, StopsAtTheLimit) {
  Isolated scene(16);
  EXPECT_EQ(scene.Unpool(Above(50), 9), 4);  // of 6: those of the largest score first
  EXPECT_EQ(scene.gaussians.means[3 * 5], 8.5f);
  EXPECT_EQ(scene.gaussians.means[3 * 8], -4.5f);  // between -9 and its nearest, 0
  EXPECT_EQ(scene.Unpool(Above(0), 9), 0);
}

TEST(UnpoolGaussians, NeedsThreeNeighbors) {
  Gaussians three = RandomGaussians(3, 1);
  EXPECT_EQ(UnpoolGaussians(Above(0), 100, &three), 0);
}

TEST(UnpoolGaussians, SameForAnyNumberOfThreads) {
  const auto run = [](int threads) {
    const Threads scope(threads);
    Gaussians g = RandomGaussians(4000, 4);
    EXPECT_GT(UnpoolGaussians(Above(0.09), 5000, &g), 100);
    return g;
  };
  EXPECT_TRUE(SameBits(run(1), run(3)));
}

}  // namespace
}  // namespace oraclegs
