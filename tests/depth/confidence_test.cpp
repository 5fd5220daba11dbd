#include "oraclegs/depth/confidence.h"

#include <gtest/gtest.h>

#include "depth/surfaces.h"

namespace oraclegs {
namespace {

constexpr DepthRange kRange{0.1f, 0.7f};
constexpr int kWidth = 96, kHeight = 72;

size_t At(int x, int y) { return static_cast<size_t>(y) * kWidth + static_cast<size_t>(x); }

class ConfidenceTest : public testing::Test {
 protected:
  /// Correct maps of these cameras.
  void See(const std::vector<Camera>& cameras) {
    scene_ = SceneOf(TakeAll(kSlanted, cameras), kRange);
    maps_.clear();
    for (const Camera& camera : cameras) maps_.push_back(TrueMap(camera, kSlanted));
  }
  void Look(int views, double step) { See(Arc(views, step)); }
  std::vector<float> Of(size_t view) const { return Confidence(scene_, view, maps_); }

  /// The maps as stereo hands them on.
  std::vector<DepthMap> DepthMaps() const {
    std::vector<DepthMap> depth;
    for (size_t v = 0; v < maps_.size(); ++v) {
      const Camera& camera = scene_.views[v].camera;
      DepthMap map{fmt::format("{}", v), camera, {}, {}, Of(v)};
      for (size_t i = 0; i < maps_[v].planes.size(); ++i) {
        const Plane& plane = maps_[v].planes[i];
        const float x = static_cast<float>(i % kWidth) + 0.5f, y = static_cast<float>(i / kWidth) + 0.5f;
        map.inv_depth.push_back(plane.inv_depth);
        map.normals.push_back(plane.inv_depth > 0 ? NormalOf(camera, plane, x, y) : Eigen::Vector3f::Zero());
      }
      depth.push_back(std::move(map));
    }
    return depth;
  }

  /// Makes all of `view` unknown except for a square.
  void KeepSquare(size_t view, int x0, int y0, int side) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (x < x0 || y < y0 || x >= x0 + side || y >= y0 + side) maps_[view].planes[At(x, y)] = {};
      }
    }
  }

  StereoScene scene_;
  std::vector<PlaneMap> maps_;
};

TEST_F(ConfidenceTest, IsHighWhereViewsAgree) {
  Look(2, 8);
  const std::vector<float> two = Of(0);
  ASSERT_EQ(two.size(), static_cast<size_t>(kWidth * kHeight));
  EXPECT_GT(two[At(48, 36)], 0.6);
  Look(4, 8);
  EXPECT_GT(Of(1)[At(48, 36)], 0.9) << "the more the better";
  for (const float c : Of(1)) EXPECT_TRUE(c >= 0 && c <= 1);
}

TEST_F(ConfidenceTest, IsLowForSingleView) {
  Look(2, 20);
  const std::vector<float> confidence = Of(0);
  const PixelMap there = MapBetween(scene_.views[0].camera, scene_.views[1].camera);
  int alone = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Eigen::Vector3f q =
          there(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, maps_[0].At(x, y).inv_depth);
      const float u = q.x() / q.z(), v = q.y() / q.z();
      if (u >= 0 && v >= 0 && u < kWidth && v < kHeight) continue;
      EXPECT_EQ(confidence[At(x, y)], 0);
      ++alone;
    }
  }
  EXPECT_GT(alone, 300);
}

TEST_F(ConfidenceTest, IsLowForFloatingPatch) {
  Look(4, 8);
  for (int y = 30; y < 44; ++y) {
    for (int x = 40; x < 60; ++x) maps_[1].planes[At(x, y)].inv_depth *= 1.25f;
  }
  const std::vector<float> confidence = Of(1);
  EXPECT_LT(confidence[At(50, 36)], 0.02);
  EXPECT_GT(confidence[At(20, 36)], 0.8) << "its surroundings are right";
  EXPECT_GT(Of(2)[At(20, 60)], 0.8) << "elsewhere the others do not mind";
}

TEST_F(ConfidenceTest, DropsWhereSeenThrough) {
  Look(4, 8);
  // Two views find a floating square, the other two look through it.
  TexturedPlane square = kSlanted;
  square.point -= 0.5 * Eigen::Vector3d(0, 0, 1);
  square.half_side = 0.3;
  for (const size_t v : {0u, 1u}) {
    const PlaneMap floating = TrueMap(scene_.views[v].camera, square);
    for (size_t i = 0; i < floating.planes.size(); ++i) {
      if (floating.planes[i].inv_depth > 0) maps_[v].planes[i] = floating.planes[i];
    }
  }
  const float through = Of(1)[At(48, 36)];
  for (const size_t v : {2u, 3u}) maps_[v].costs.assign(maps_[v].costs.size(), 0.9f);  // nor are those sure themselves
  const float unsure = Of(1)[At(48, 36)];
  EXPECT_GT(unsure, 0.5);
  EXPECT_LT(through, 0.7f * unsure);
}

TEST_F(ConfidenceTest, IsLowForDissimilarPatches) {
  Look(3, 8);
  const float alike = Of(1)[At(48, 36)];
  maps_[1].costs.assign(maps_[1].costs.size(), 1);  // as chance would have it
  EXPECT_LT(Of(1)[At(48, 36)], alike / 3);
  maps_[1].costs.assign(maps_[1].costs.size(), kWorstCost);
  EXPECT_EQ(Of(1)[At(48, 36)], 0);
}

TEST_F(ConfidenceTest, IsLowAtSmallAngles) {
  See({CameraAt({-0.014, 0, -4}, {0, 0, 0}, kWidth, kHeight), CameraAt({0.014, 0, -4}, {0, 0, 0}, kWidth, kHeight)});
  EXPECT_LT(Of(0)[At(48, 36)], 0.3);
}

TEST_F(ConfidenceTest, DampsSmallIslands) {
  Look(3, 8);
  const float whole = Of(1)[At(50, 36)];
  const std::vector<PlaneMap> right = maps_;
  KeepSquare(1, 48, 33, 7);
  EXPECT_FLOAT_EQ(Of(1)[At(50, 36)], whole) << "49 pixels are a surface";
  maps_ = right;
  KeepSquare(1, 48, 34, 6);
  EXPECT_FLOAT_EQ(Of(1)[At(50, 36)], 0.3f * whole) << "36 are not";
}

TEST_F(ConfidenceTest, DampsOutliers) {
  Look(3, 8);
  const float whole = Of(1)[At(50, 36)];
  // Its own depth is right, that of all around it is not.
  for (int y = 30; y < 43; ++y) {
    for (int x = 44; x < 57; ++x) {
      if (x != 50 || y != 36) maps_[1].planes[At(x, y)].inv_depth *= 1.1f;
    }
  }
  EXPECT_LE(Of(1)[At(50, 36)], 0.31f * whole);
}

TEST_F(ConfidenceTest, IsZeroAtUnknownAndUnusablePixels) {
  Look(3, 8);
  maps_[1].planes[At(50, 36)] = {};
  scene_.views[1].usable.assign(static_cast<size_t>(kWidth * kHeight), 1);
  scene_.views[1].usable[At(30, 30)] = 0;
  const std::vector<float> confidence = Of(1);
  EXPECT_EQ(confidence[At(50, 36)], 0);
  EXPECT_EQ(confidence[At(30, 30)], 0);
  EXPECT_GT(confidence[At(31, 30)], 0.5);
}

TEST_F(ConfidenceTest, WithoutAViewIsThatOfTheOthers) {
  const std::vector<Camera> cameras = Arc(4, 8);
  See({cameras[0], cameras[2], cameras[3]});
  const std::vector<float> others = Of(0);
  See(cameras);
  const std::vector<DepthMap> maps = DepthMaps();
  const std::vector<float> without = ConfidenceWithout(maps, 0, {1});
  double fallen = 0;
  for (size_t i = 0; i < others.size(); ++i) {
    ASSERT_NEAR(without[i], others[i], 0.02) << i;
    fallen += maps[0].confidence[i] - without[i];
  }
  EXPECT_GT(fallen / static_cast<double>(others.size()), 0.05);
  EXPECT_EQ(ConfidenceWithout(maps, 0, {}), maps[0].confidence);
  for (const float c : ConfidenceWithout(maps, 0, {1, 2, 3})) EXPECT_EQ(c, 0) << "nobody is left to agree";
}

TEST_F(ConfidenceTest, WithoutAViewDoesNotDependOnIt) {
  Look(4, 8);
  const float sure = Of(0)[At(48, 36)];
  const std::vector<float> before = ConfidenceWithout(DepthMaps(), 0, {1});
  for (Plane& plane : maps_[1].planes) plane.inv_depth *= 1.02f;
  maps_[1].costs.assign(maps_[1].costs.size(), kWorstCost);
  ASSERT_LT(Of(0)[At(48, 36)], 0.98f * sure) << "it no longer agrees";
  const std::vector<float> after = ConfidenceWithout(DepthMaps(), 0, {1});
  for (size_t i = 0; i < before.size(); ++i) ASSERT_NEAR(after[i], before[i], 1e-5) << i;
}

TEST_F(ConfidenceTest, WithoutAViewIsThatOfTheOnesThatStandIn) {
  Look(13, 3);
  const std::vector<DepthMap> maps = DepthMaps();
  const std::vector<float> without = ConfidenceWithout(maps, 6, {5});
  EXPECT_NEAR(without[At(48, 36)], maps[6].confidence[At(48, 36)], 0.01);
}

}  // namespace
}  // namespace oraclegs
