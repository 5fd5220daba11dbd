#include "oraclegs/depth/fusion.h"

#include <gtest/gtest.h>

#include "depth/surfaces.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

/// Views of one plane. Stereo knows its depth except for a square in the middle, where a network does.
class PriorPointsTest : public testing::Test {
 protected:
  void SetUp() override {
    views = TakeAll(kSlanted, Arc(3, 6));
    for (const LoadedView& view : views) {
      maps.push_back(TrueDepth(view, kSlanted, 0.9f));
      maps.back().monocular = true;
      for (int y = 25; y < 47; ++y) {
        for (int x = 36; x < 60; ++x) maps.back().confidence[static_cast<size_t>(y * 96 + x)] = 0.3f;
      }
    }
    dense = FuseDepth(maps, views, {});
  }
  std::vector<DensePoint> Fill() const { return PriorPoints(maps, views, dense, {}); }

  std::vector<LoadedView> views;
  std::vector<DepthMap> maps;
  std::vector<DensePoint> dense;
};

TEST_F(PriorPointsTest, FillUncoveredPixelsOnce) {
  const std::vector<DensePoint> points = Fill();
  // A square of 22 x 24 pixels has 8 x 8 cells of three; the views' squares overlap on the plane.
  EXPECT_GT(points.size(), 20u);
  EXPECT_LT(points.size(), 150u);
  for (const DensePoint& p : points) {
    EXPECT_NEAR((p.xyz.cast<double>() - kSlanted.point).dot(kSlanted.normal), 0, 0.01);
    EXPECT_GT(p.normal.dot(kSlanted.normal.cast<float>()), 0.99f);
    EXPECT_FLOAT_EQ(p.confidence, 0.3f);
    EXPECT_EQ(p.views, 1);
    EXPECT_GT(p.pixel_size, 0);
  }
  const auto same = Fill();
  SetNumThreads(3);
  const auto three = Fill();
  SetNumThreads(0);
  ASSERT_EQ(same.size(), three.size());
  for (size_t i = 0; i < same.size(); ++i) EXPECT_EQ(same[i].xyz, three[i].xyz);
}

TEST_F(PriorPointsTest, AreNoneWithoutMonocularMaps) {
  for (DepthMap& map : maps) map.monocular = false;
  EXPECT_TRUE(Fill().empty());
  EXPECT_TRUE(PriorPoints({}, {}, {}, {}).empty());
}

TEST_F(PriorPointsTest, SkipWhereSeenThrough) {
  // The first view's network says something hangs half way; the others see the plane behind it for sure.
  for (size_t i = 0; i < maps[0].size(); ++i) {
    if (maps[0].confidence[i] < kConfident) maps[0].inv_depth[i] *= 2;
  }
  for (size_t v = 1; v < maps.size(); ++v) maps[v] = TrueDepth(views[v], kSlanted, 0.9f);
  dense.clear();
  EXPECT_TRUE(Fill().empty());
}

TEST_F(PriorPointsTest, DivideColorsByGains) {
  FusionOptions options;
  options.gains.assign(3, Eigen::Vector3f::Constant(2));
  const std::vector<DensePoint> plain = Fill(), freed = PriorPoints(maps, views, dense, options);
  ASSERT_EQ(plain.size(), freed.size());
  for (size_t i = 0; i < plain.size(); ++i) EXPECT_LT((freed[i].rgb - plain[i].rgb / 2).norm(), 1e-5f);
}

}  // namespace
}  // namespace oraclegs
