#include "oraclegs/depth/patch_search.h"

#include <gtest/gtest.h>

#include "depth/surfaces.h"

namespace oraclegs {
namespace {

class PatchSearchTest : public testing::Test {
 protected:
  /// The pixel of view 0 at the middle, on the surface.
  OffsetPixel Middle() const {
    const PlaneMap truth = TrueMap(views[0].camera, kSlanted);
    const Plane& plane = truth.At(80, 60);
    return {0, 80.5f, 60.5f, plane.inv_depth, plane.dx / plane.inv_depth, plane.dy / plane.inv_depth};
  }
  std::optional<Eigen::Vector2f> Find(const Eigen::Vector2f& start) const {
    const ImageF view = SearchPyramid(views[0].rgb).front(), other = SearchPyramid(views[1].rgb).front();
    const auto warped = WarpPatch(MapBetween(views[0].camera, views[1].camera), Middle(), {1, 1});
    return FindPatch(SearchPatchAt(view, TrueDepth(views[0], kSlanted, 1), Middle(), {1, 1}), *warped, other, start);
  }

  std::vector<LoadedView> views = TakeAll(kSlanted, Arc(2, 8, 160, 120));
};

TEST_F(PatchSearchTest, FindsThePatchFromPixelsAway) {
  for (const Eigen::Vector2f& start :
       {Eigen::Vector2f(0, 0), Eigen::Vector2f(1, -0.7f), Eigen::Vector2f(-1.2f, 0.5f)}) {
    const auto shift = Find(start);
    ASSERT_TRUE(shift);
    EXPECT_LT(shift->norm(), 0.06f);
  }
}

TEST_F(PatchSearchTest, DoesNotDependOnGainAndOffset) {
  const auto before = Find({0.5f, 0.5f});
  for (float& value : views[1].rgb.data) value = 0.3f + 0.4f * value;
  const auto after = Find({0.5f, 0.5f});
  ASSERT_TRUE(before && after);
  EXPECT_LT((*before - *after).norm(), 0.01f);
}

TEST_F(PatchSearchTest, RefusesAnotherPatch) {
  for (size_t i = 0; i < views[1].rgb.data.size(); ++i) {
    views[1].rgb.data[i] = 0.5f + 0.4f * std::sin(1.7f * static_cast<float>(i));
  }
  EXPECT_FALSE(Find({0, 0}));
}

TEST_F(PatchSearchTest, NeedsASurfaceWithTexture) {
  const DepthMap map = TrueDepth(views[0], kSlanted, 1);
  const std::vector<ImageF> levels = SearchPyramid(views[0].rgb);
  ASSERT_EQ(levels.size(), 2u);
  EXPECT_EQ(levels[1].width, 80);
  const SearchPatch patch = SearchPatchAt(levels[0], map, Middle(), {1, 1});
  EXPECT_TRUE(patch.IsSurface());
  EXPECT_TRUE(patch.HasTexture());
  DepthMap unknown = map;
  unknown.inv_depth.assign(unknown.size(), 0);
  EXPECT_FALSE(SearchPatchAt(levels[0], unknown, Middle(), {1, 1}).IsSurface());
  EXPECT_FALSE(SearchPatchAt(levels[0], unknown, Middle(), {1, 1}).HasTexture());
  const ImageF flat{160, 120, 1, std::vector<float>(160 * 120, 90.f)};
  EXPECT_FALSE(SearchPatchAt(flat, map, Middle(), {1, 1}).HasTexture());
}

TEST_F(PatchSearchTest, WarpsAsThePlaneDoes) {
  const PixelMap map = MapBetween(views[0].camera, views[1].camera);
  const auto warped = WarpPatch(map, Middle(), {1, 1});
  ASSERT_TRUE(warped);
  const PlaneMap truth = TrueMap(views[0].camera, kSlanted);
  const Eigen::Vector3f corner =
      map(80.5f - kSearchRadius, 60.5f - kSearchRadius, truth.At(80 - kSearchRadius, 60 - kSearchRadius).inv_depth);
  EXPECT_LT((warped->at.front() - corner.head<2>() / corner.z()).norm(), 1e-3f);
  const Eigen::Vector2f across = warped->at[kSearchSamples / 2 + 1] - warped->at[kSearchSamples / 2];
  EXPECT_LT((warped->by_pixel.col(0) - across).norm(), 0.01f);
  OffsetPixel behind = Middle();
  behind.inv_depth = 100;
  PixelMap backward = map;
  backward.translation = Eigen::Vector3f(0, 0, -1);
  EXPECT_FALSE(WarpPatch(backward, behind, {1, 1}));
}

TEST_F(PatchSearchTest, ReadsImagesOfOnePixel) {
  const std::vector<ImageF> levels = SearchPyramid({1, 1, 3, {0.2f, 0.2f, 0.2f}});
  ASSERT_EQ(levels.size(), 1u);
  EXPECT_NEAR(levels[0].data[0], 51, 0.1);
}

}  // namespace
}  // namespace oraclegs
