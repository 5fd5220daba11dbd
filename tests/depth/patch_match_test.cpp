#include "oraclegs/depth/patch_match.h"

#include <gtest/gtest.h>

#include "depth/surfaces.h"
#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

class ThreadsAsBefore : public testing::Test {
 protected:
  ~ThreadsAsBefore() override { SetNumThreads(before_); }

 private:
  int before_ = NumThreads();
};

bool Same(const Plane& a, const Plane& b) { return a.inv_depth == b.inv_depth && a.dx == b.dx && a.dy == b.dy; }

TEST(RandomPlanes, FillRangeAndStartAtHints) {
  const StereoScene scene = SceneOf(TakeAll(kSteep, Arc(2, 8)), kSteepRange);
  std::vector<float> hints(96 * 72, 0);
  hints[500] = 0.37f;
  const PlaneMap map = RandomPlanes(scene, 0, hints);
  ASSERT_EQ(map.planes.size(), 96u * 72u);
  EXPECT_TRUE(Same(map.planes[500], {0.37f, 0, 0}));
  float low = 1, high = 0;
  int tilted = 0;
  for (const Plane& plane : map.planes) {
    low = std::min(low, plane.inv_depth);
    high = std::max(high, plane.inv_depth);
    tilted += plane.dx != 0 ? 1 : 0;
  }
  EXPECT_GE(low, kSteepRange.far);
  EXPECT_LE(high, kSteepRange.near);
  EXPECT_GT(high - low, 0.95f * (kSteepRange.near - kSteepRange.far));
  EXPECT_GT(tilted, 6000);
  EXPECT_EQ(map.costs, std::vector<float>(96 * 72, kWorstCost));
  EXPECT_FALSE(Same(RandomPlanes(scene, 1, {}).planes[7], map.planes[7]));
}

TEST(RandomPlanes, SkipUnusablePixels) {
  StereoScene scene = SceneOf(TakeAll(kSteep, Arc(2, 8)), kSteepRange);
  scene.views[0].usable.assign(96 * 72, 1);
  scene.views[0].usable[321] = 0;
  PlaneMap map = RandomPlanes(scene, 0, {});
  EXPECT_EQ(map.planes[321].inv_depth, 0);
  RunPass(scene, 0, {1, 0, nullptr}, &map);
  EXPECT_EQ(map.planes[321].inv_depth, 0);
  EXPECT_EQ(map.costs[321], kWorstCost);
}

TEST(RunPass, FindsSlantedPlaneFromRandom) {
  const StereoScene scene = SceneOf(TakeAll(kSteep, Arc(3, 8)), kSteepRange);
  const PlaneMap truth = TrueMap(scene.views[1].camera, kSteep);
  PlaneMap map = RandomPlanes(scene, 1, {});
  EXPECT_LT(ShareRight(map, truth, 0.02f), 0.1);
  RunPass(scene, 1, {4, 0, nullptr}, &map);
  EXPECT_GT(ShareRight(map, truth, 0.02f), 0.9);
  double cosine = 0;
  const Eigen::Vector3f normal = (scene.views[1].camera.cam_from_world.linear() * kSteep.normal).cast<float>();
  for (int y = 20; y < 52; ++y) {
    for (int x = 30; x < 66; ++x) {
      cosine += normal.dot(NormalOf(scene.views[1].camera, map.At(x, y), static_cast<float>(x) + 0.5f,
                                    static_cast<float>(y) + 0.5f)) /
                (32 * 36);
    }
  }
  EXPECT_GT(cosine, 0.9) << "the slant, too";
  for (const float cost : map.costs) EXPECT_TRUE(cost >= 0 && cost <= kWorstCost);
}

TEST(RunPass, GeometricTermFollowsOtherMaps) {
  const StereoScene scene = SceneOf(TakeAll(kSteep, Arc(3, 8)), kSteepRange);
  std::vector<PlaneMap> maps;
  for (const StereoView& view : scene.views) maps.push_back(TrueMap(view.camera, kSteep));
  PlaneMap without = RandomPlanes(scene, 1, {}), with = without;
  RunPass(scene, 1, {2, 0, nullptr}, &without);
  RunPass(scene, 1, {2, 0, &maps}, &with);
  EXPECT_GT(ShareRight(with, maps[1], 0.01f), ShareRight(without, maps[1], 0.01f));
}

TEST(RunPass, RefinesAndFindsNothingNewWhereLocal) {
  const StereoScene scene = SceneOf(TakeAll(kSteep, Arc(3, 8)), kSteepRange);
  const PlaneMap truth = TrueMap(scene.views[1].camera, kSteep);
  const auto run_from = [&](float factor) {
    PlaneMap map = truth;
    for (Plane& plane : map.planes) plane = {factor * plane.inv_depth, factor * plane.dx, factor * plane.dy};
    map.costs.assign(map.costs.size(), kWorstCost);
    RunPass(scene, 1, {2, 0, nullptr, true}, &map);
    return ShareRight(map, truth, 0.005f);
  };
  EXPECT_GT(run_from(1.02f), 0.8);
  EXPECT_LT(run_from(1.5f), 0.1) << "too far for small steps";
}

TEST(RunPass, ChangesNothingWithoutSources) {
  StereoScene scene = SceneOf(TakeAll(kSteep, Arc(2, 8)), kSteepRange);
  scene.views[0].neighbors.clear();
  const PlaneMap before = RandomPlanes(scene, 0, {});
  PlaneMap map = before;
  RunPass(scene, 0, {2, 0, nullptr}, &map);
  EXPECT_TRUE(std::equal(map.planes.begin(), map.planes.end(), before.planes.begin(), Same));
}

TEST(RunPass, StaysWithinSilhouettes) {
  TexturedPlane square = kSteep;
  square.half_side = 0.7;
  // The third camera looks along the square and rules most depths out.
  std::vector<Camera> cameras = Arc(2, 8);
  cameras.push_back(CameraAt({3.5, 0, 0.5}, {0, 0, 0.3}, 96, 72));
  const std::vector<LoadedView> views = TakeAll(square, cameras);
  const Silhouettes silhouettes(views);
  ASSERT_FALSE(silhouettes.empty());
  StereoScene scene = SceneOf(views, kSteepRange);
  scene.silhouettes = &silhouettes;
  for (size_t v = 0; v < 3; ++v) scene.views[v].usable = silhouettes.Object(v);
  PlaneMap map = RandomPlanes(scene, 0, {});
  RunPass(scene, 0, {2, 0, nullptr}, &map);
  const PixelMap there = MapBetween(cameras[0], cameras[2]);
  int compared = 0;
  for (int y = 0; y < 72; ++y) {
    for (int x = 0; x < 96; ++x) {
      if (!(map.costs[static_cast<size_t>(y) * 96 + x] < kWorstCost)) continue;
      const Eigen::Vector3f q =
          there(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, map.At(x, y).inv_depth);
      EXPECT_TRUE(silhouettes.MayContain(2, q.x() / q.z(), q.y() / q.z())) << x << " " << y;
      EXPECT_TRUE(map.At(x, y).inv_depth >= kSteepRange.far && map.At(x, y).inv_depth <= kSteepRange.near);
      ++compared;
    }
  }
  EXPECT_GT(compared, 500);
}

using RunPassThreads = ThreadsAsBefore;

TEST_F(RunPassThreads, GiveSameBits) {
  const StereoScene scene = SceneOf(TakeAll(kSteep, Arc(3, 8)), kSteepRange);
  const PlaneMap start = RandomPlanes(scene, 0, {});
  PlaneMap one = start, four = start;
  SetNumThreads(1);
  RunPass(scene, 0, {2, 3, nullptr}, &one);
  SetNumThreads(4);
  RunPass(scene, 0, {2, 3, nullptr}, &four);
  EXPECT_TRUE(std::equal(one.planes.begin(), one.planes.end(), four.planes.begin(), Same));
  EXPECT_EQ(one.costs, four.costs);
}

TEST(Resized, KeepsPlanesAtOtherResolution) {
  const Camera small = CameraAt({0, 0.2, -4}, {0, 0, 0}, 48, 36), large = Resized(small, 96, 72);
  const PlaneMap truth = TrueMap(large, kSteep), from_small = Resized(TrueMap(small, kSteep, 0.4f), 96, 72);
  ASSERT_EQ(from_small.planes.size(), truth.planes.size());
  for (size_t i = 0; i < truth.planes.size(); ++i) {
    EXPECT_NEAR(from_small.planes[i].inv_depth, truth.planes[i].inv_depth, 1e-5);
    EXPECT_NEAR(from_small.planes[i].dx, truth.planes[i].dx, 1e-6);
    EXPECT_NEAR(from_small.planes[i].dy, truth.planes[i].dy, 1e-6);
    EXPECT_EQ(from_small.costs[i], 0.4f);
  }
  EXPECT_GT(ShareRight(Resized(truth, 41, 29), TrueMap(Resized(small, 41, 29), kSteep), 1e-4f), 0.999);
}

TEST(Resized, KeepsDepthPositive) {
  const PlaneMap map = Resized(PlaneMap{1, 1, {{0.1f, 1, 0}}, {0.5f}}, 4, 1);
  EXPECT_EQ(map.planes[0].inv_depth, 0);
  EXPECT_GT(map.planes[3].inv_depth, 0.1f);
}

TEST(GoAndReturn, ReturnsToStartOnSameSurface) {
  const std::vector<Camera> cameras = Arc(2, 12);
  const PlaneMap a = TrueMap(cameras[0], kSteep), b = TrueMap(cameras[1], kSteep);
  const PlainPixelMap there = Plain(MapBetween(cameras[0], cameras[1])),
                      back = Plain(MapBetween(cameras[1], cameras[0]));
  const float w = a.At(50, 30).inv_depth;
  const RoundTrip right = GoAndReturn(there, back, Known(b), {50.5f, 30.5f, w});
  EXPECT_TRUE(right.seen);
  EXPECT_NEAR(right.pixels, 0, 1e-2);
  EXPECT_NEAR(right.relative_depth, 0, 1e-3);
  const RoundTrip hidden = GoAndReturn(there, back, Known(b), {50.5f, 30.5f, 0.9f * w});
  EXPECT_TRUE(hidden.seen);
  EXPECT_GT(hidden.pixels, 1);
  EXPECT_GT(hidden.relative_depth, 0.05);
  EXPECT_LT(GoAndReturn(there, back, Known(b), {50.5f, 30.5f, 1.1f * w}).relative_depth, -0.05) << "in front of it";
}

TEST(GoAndReturn, IsUnseenOutOfFrameOrAtUnknownDepth) {
  const std::vector<Camera> cameras = Arc(2, 12);
  PlaneMap b = TrueMap(cameras[1], kSteep);
  const PlainPixelMap there = Plain(MapBetween(cameras[0], cameras[1])),
                      back = Plain(MapBetween(cameras[1], cameras[0]));
  EXPECT_FALSE(GoAndReturn(there, back, Known(b), {50.5f, 30.5f, 1e3f}).seen) << "in front of the first camera";
  const Camera ahead = CameraAt({0, 0, 5}, {0, 0, 9}, 96, 72);
  EXPECT_FALSE(GoAndReturn(Plain(MapBetween(cameras[0], ahead)), Plain(MapBetween(ahead, cameras[0])), Known(b),
                           {50.5f, 30.5f, 0.25f})
                   .seen);
  for (Plane& plane : b.planes) plane = {};
  EXPECT_FALSE(GoAndReturn(there, back, Known(b), {50.5f, 30.5f, 0.25f}).seen);
}

}  // namespace
}  // namespace oraclegs
