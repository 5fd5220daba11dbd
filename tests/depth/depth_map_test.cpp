#include "oraclegs/depth/depth_map.h"

#include <gtest/gtest.h>

#include "depth/rig.h"

namespace oraclegs {
namespace {

const Camera kLeft = CameraAt({-0.5, 0, -4}, {0, 0, 0}), kRight = CameraAt({0.5, 0.1, -4}, {0, 0, 0});
const TexturedPlane kWall{{0, 0, 0.5}, Eigen::Vector3d(0.2, -0.1, -1).normalized()};

DepthMap TrueMap(const Camera& camera, float confidence = 1) {
  DepthMap map{"view", camera, {}, {}, {}};
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      map.inv_depth.push_back(static_cast<float>(1 / kWall.DepthAt(camera, x + 0.5, y + 0.5)));
      map.normals.emplace_back(0, 0, -1);
      map.confidence.push_back(confidence);
    }
  }
  return map;
}

class FindPixelTest : public testing::Test {
 protected:
  std::optional<size_t> Find(const DepthMap& other, size_t index) const {
    return FindPixel(other, MapBetween(kLeft, kRight), MapBetween(kRight, kLeft), PixelOf(left, index), {});
  }
  static constexpr size_t kMiddle = 60 * 160 + 80;
  DepthMap left = TrueMap(kLeft), right = TrueMap(kRight);
};

TEST_F(FindPixelTest, FindsPixelOfSamePoint) {
  const auto found = Find(right, kMiddle);
  ASSERT_TRUE(found);
  const Eigen::Vector3f here = PixelOf(left, kMiddle), there = PixelOf(right, *found);
  const auto world = [](const Camera& camera, const Eigen::Vector3f& uvw) -> Eigen::Vector3d {
    return camera.cam_from_world.inverse() * (RayOf(camera, uvw.x(), uvw.y()) / uvw.z()).cast<double>().eval();
  };
  EXPECT_LT((world(kLeft, here) - world(kRight, there)).norm(), 0.03) << "a pixel is 0.025 wide there";
}

TEST_F(FindPixelTest, RejectsOccluder) {
  for (float& w : right.inv_depth) w *= 1.5f;  // something nearer stands before the right camera
  EXPECT_FALSE(Find(right, kMiddle));
}

TEST_F(FindPixelTest, IgnoresUnconfidentDepth) {
  EXPECT_FALSE(Find(TrueMap(kRight, 0.2f), kMiddle));
  EXPECT_TRUE(Find(TrueMap(kRight, 0.4f), kMiddle));
}

TEST_F(FindPixelTest, RejectsPointsOutOfFrame) {
  left.inv_depth[kMiddle] = 4;  // right before the camera: far beside the right image
  EXPECT_FALSE(Find(right, kMiddle));
}

TEST(ConfidentShare, IncludesThreshold) {
  DepthMap map;
  EXPECT_EQ(ConfidentShare(map), 0) << "of no pixels at all";
  map.inv_depth = {1, 1, 1, 1};
  map.confidence = {0, kConfident, 0.99f * kConfident, 1};
  EXPECT_EQ(map.size(), 4u);
  EXPECT_EQ(ConfidentShare(map), 0.5);
}

TEST(RelativeSlope, ContinuesThePlane) {
  DepthMap map = TrueMap(kLeft);
  const Eigen::Vector3f normal = (kLeft.cam_from_world.linear() * kWall.normal).cast<float>();
  map.normals.assign(map.size(), normal);
  const auto width = static_cast<size_t>(kLeft.width), middle = 60 * width + 80;
  const auto slope = RelativeSlope(map, middle);
  ASSERT_TRUE(slope);
  const float w = map.inv_depth[middle];
  EXPECT_NEAR(w * (1 + slope->x()), map.inv_depth[middle + 1], 1e-5f);
  EXPECT_NEAR(w * (1 + slope->y()), map.inv_depth[middle + width], 1e-5f);
  EXPECT_GT(slope->norm(), 1e-4f);
  map.normals[middle] = -normal;
  EXPECT_FALSE(RelativeSlope(map, middle));
}

}  // namespace
}  // namespace oraclegs
