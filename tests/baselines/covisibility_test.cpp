#include "oraclegs/baselines/covisibility.h"

#include <gtest/gtest.h>

#include "support/buffers.h"
#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

/// Looks along z from (x, 0, 0) at a wall at z = 4; a pixel is 0.2 wide there, the image 4 x 3.2.
CovisibilityView WallFrom(double x) {
  CovisibilityView view{
      {20, 16, 20, 20, 10, 8, Eigen::Isometry3d::Identity()}, Buffer<float>::Full({16, 20}, 0.25f), {}};
  view.camera.cam_from_world.translation() = Eigen::Vector3d(-x, 0, 0);
  return view;
}

/// Values of a row's pixels.
std::vector<float> RowOf(const Buffer<float>& map, int64_t row) {
  const auto numbers = map.Rows(row, row + 1).span();
  return {numbers.begin(), numbers.end()};
}

std::vector<float> Steps(std::initializer_list<std::pair<int, float>> runs) {
  std::vector<float> out;
  for (const auto& [count, value] : runs) out.insert(out.end(), count, value);
  return out;
}

TEST(CovisibilityMap, CountsTheViewsThatSeeTheWall) {
  // 5 and 10 pixels to the right, and one that sees nothing of it.
  const std::vector<CovisibilityView> views = {WallFrom(0), WallFrom(1), WallFrom(2), WallFrom(9)};
  for (int64_t row = 0; row < 16; ++row) {
    EXPECT_EQ(RowOf(CovisibilityMap(views, 0), row), Steps({{5, 0}, {5, 1}, {10, 2}}));
    EXPECT_EQ(RowOf(CovisibilityMap(views, 1), row), Steps({{5, 1}, {10, 2}, {5, 1}}));
    EXPECT_EQ(RowOf(CovisibilityMap(views, 3), row), Steps({{20, 0}}));
  }
}

TEST(CovisibilityMap, NeedsDepthsThatAgree) {
  std::vector<CovisibilityView> views = {WallFrom(0), WallFrom(1)};
  views[1].inv_depth[3 * 20 + 7] = 0.25f / 1.04f;  // within 5%: still the wall
  views[1].inv_depth[3 * 20 + 8] = 0.25f / 0.9f;   // something before it
  views[1].inv_depth[3 * 20 + 9] = 0;              // nothing
  EXPECT_EQ(RowOf(CovisibilityMap(views, 0), 3), Steps({{5, 0}, {8, 1}, {2, 0}, {5, 1}}));
  EXPECT_EQ(RowOf(CovisibilityMap(views, 0, 0.01), 3), Steps({{5, 0}, {7, 1}, {3, 0}, {5, 1}}));
}

TEST(CovisibilityMap, IgnoresUnknownDepth) {
  std::vector<CovisibilityView> views = {WallFrom(0), WallFrom(1), WallFrom(0)};
  views[0].mask = Buffer<float>::Full({16, 20}, 1.f);
  views[0].mask[2 * 20 + 6] = 0.5f;
  views[1].mask = Buffer<float>::Full({16, 20}, 1.f);
  views[1].mask[2 * 20 + 2] = 0;
  views[2].inv_depth = {};
  EXPECT_EQ(RowOf(CovisibilityMap(views, 0), 2), Steps({{5, 0}, {1, 1}, {2, 0}, {12, 1}}));
  EXPECT_EQ(MaxAbs(CovisibilityMap(views, 2)), 0);
}

TEST(CovisibilityMap, IgnoresWhatLiesBehindTheOther) {
  std::vector<CovisibilityView> views = {WallFrom(0), WallFrom(0)};
  views[1].camera.cam_from_world.linear() = Eigen::AngleAxisd(3.14159265, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_EQ(MaxAbs(CovisibilityMap(views, 0)), 0);
}

TEST(CovisibilityWeights, AreLargestWhereOneViewIsAlone) {
  const Buffer<float> map = Buffer<float>::From({1, 3}, {0, 1, 3});
  EXPECT_TRUE(Equal(CovisibilityWeights(map), Buffer<float>::From({1, 3}, {1, 0.5f, 0.25f})));
}

TEST(CovisibilityMap, SameForAnyNumberOfThreads) {
  std::vector<CovisibilityView> views = {WallFrom(0), WallFrom(1), WallFrom(0.3)};
  views[2].inv_depth = RandomUniform({16, 20}, 1);
  const auto run = [&](int threads) {
    const Threads scope(threads);
    return CovisibilityMap(views, 0);
  };
  EXPECT_TRUE(SameBytes(run(1), run(3)));
}

TEST(CovisibilityMap, RefusesWhatDoesNotFit) {
  std::vector<CovisibilityView> views = {WallFrom(0), WallFrom(1)};
  EXPECT_THROW(CovisibilityMap(views, 2), ShapeError);
  views[1].mask = Buffer<float>::Zeros({20, 16});
  EXPECT_THROW(CovisibilityMap(views, 0), ShapeError);
  EXPECT_THROW(CovisibilityWeights(Buffer<float>::Zeros({4})), ShapeError);
}

}  // namespace
}  // namespace oraclegs
