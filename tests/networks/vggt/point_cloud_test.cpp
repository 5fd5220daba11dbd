#include "oraclegs/networks/vggt/point_cloud.h"

#include <cmath>

#include "networks/vggt/fixture.h"

namespace oraclegs::vggt {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

Image8 Colored(int width, int height) {
  Image8 image{width, height, 3, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (const int value : {x, y, 7}) image.data.push_back(static_cast<uint8_t>(value));
    }
  }
  return image;
}

/// Cameras beside each other that look straight at the wall z = 4, in a field of view of `fov` along each axis.
struct Wall {
  std::vector<Image8> photos = {Colored(140, 112), Colored(140, 112), Colored(112, 140)};
  Input input = PrepareInput(photos, Fit::kWhole, 70, 14);
  Tensor encoding = torch::zeros({3, 9});
  std::vector<std::string> names = {"a.jpg", "b.jpg", "c.jpg"};

  explicit Wall(float fov = 1.f) {
    for (int v = 0; v < 3; ++v) {
      encoding[v][0] = -0.4f * static_cast<float>(v);  // the camera's center is at +0.4 v
      encoding[v][6] = 1.f;
      encoding[v][7] = fov, encoding[v][8] = fov;
    }
  }
  DepthPrediction Depth() const { return {torch::full({3, 70, 70}, 4.f), torch::full({3, 70, 70}, 2.f)}; }
};

TEST(ImageCameras, AreInTheImagesOwnPixels) {
  const Wall wall;
  ASSERT_EQ(wall.input.images.sizes(), (std::vector<int64_t>{3, 3, 70, 70}));  // 70 x 56 and 56 x 70, padded
  const std::vector<Camera> cameras = ImageCameras(wall.encoding, wall.input, wall.photos, wall.names);
  const double f = 35 / std::tan(0.5);  // of the input, 70 pixels for one radian
  EXPECT_EQ(cameras[0].width, 140);
  EXPECT_NEAR(cameras[0].fx, 2 * f, 1e-3);
  EXPECT_NEAR(cameras[0].fy, 2 * f, 1e-3);
  EXPECT_NEAR(cameras[0].cx, 70, 1e-4);
  EXPECT_NEAR(cameras[0].cy, 56, 1e-4);  // the middle, for the padding is even
  EXPECT_EQ(cameras[2].height, 140);
  EXPECT_NEAR(cameras[2].cx, 56, 1e-4);
  EXPECT_NEAR(cameras[2].cy, 70, 1e-4);
  EXPECT_TRUE(cameras[1].Center().isApprox(Eigen::Vector3d(0.4, 0, 0), 1e-6));
  for (const Camera& camera : cameras) EXPECT_NO_THROW(camera.Check("camera"));
}

TEST(ImageCameras, ThoseWithoutACameraAreNamed) {
  Wall wall;
  wall.encoding[0][7] = 0.f;
  wall.encoding[2][1] = std::nanf("");
  EXPECT_THAT(
      [&] { ImageCameras(wall.encoding, wall.input, wall.photos, wall.names); },
      ThrowsMessage<InputError>(AllOf(StartsWith("a.jpg, c.jpg: VGGT finds no camera"), HasSubstr("--poses colmap"))));
}

TEST(MakeCloud, PointsStandOnTheSurfaceInTheColorsOfTheirPixels) {
  const Wall wall;
  const std::vector<Camera> cameras = ImageCameras(wall.encoding, wall.input, wall.photos, wall.names);
  const DepthPrediction depth = wall.Depth();
  const std::vector<CloudPoint> cloud = MakeCloud({cameras, wall.photos, wall.input, depth}, 1000);
  ASSERT_GT(cloud.size(), 300u);
  EXPECT_LE(cloud.size(), 1200u);
  for (const CloudPoint& point : cloud) {
    EXPECT_NEAR(point.xyz.z(), 4, 1e-4);
    ASSERT_GE(point.sights.size(), 2u);
    for (const CloudSight& sight : point.sights) {
      const Camera& camera = cameras[static_cast<size_t>(sight.view)];
      const Eigen::Vector3d local = camera.cam_from_world * point.xyz;
      EXPECT_NEAR(sight.pixel.x(), camera.fx * local.x() / local.z() + camera.cx, 1e-6);
      EXPECT_GE(sight.pixel.x(), 0);
      EXPECT_LE(sight.pixel.x(), camera.width);
      EXPECT_GE(sight.pixel.y(), 0);
      EXPECT_LE(sight.pixel.y(), camera.height);
    }
    EXPECT_EQ(point.rgb[2], 7);
    const bool from_some_pixel = std::any_of(point.sights.begin(), point.sights.end(), [&](const CloudSight& sight) {
      return static_cast<int>(sight.pixel.x()) == point.rgb[0] && static_cast<int>(sight.pixel.y()) == point.rgb[1];
    });
    EXPECT_TRUE(from_some_pixel);
  }
}

TEST(MakeCloud, WhatNoOtherImageConfirmsOrIsUnsureIsLeftOut) {
  const Wall wall;
  const std::vector<Camera> cameras = ImageCameras(wall.encoding, wall.input, wall.photos, wall.names);
  DepthPrediction depth = wall.Depth();
  depth.depth[0].fill_(9.f);
  depth.confidence[1].slice(0, 0, 35).fill_(1.f);
  const std::vector<CloudPoint> cloud = MakeCloud({cameras, wall.photos, wall.input, depth}, 1000);
  ASSERT_FALSE(cloud.empty());
  for (const CloudPoint& point : cloud) {
    EXPECT_NEAR(point.xyz.z(), 4, 1e-4);
    for (const CloudSight& sight : point.sights) EXPECT_NE(sight.view, 0);
  }
  depth.depth.fill_(std::nanf(""));
  EXPECT_TRUE(MakeCloud({cameras, wall.photos, wall.input, depth}, 1000).empty());
  EXPECT_THROW(MakeCloud({cameras, wall.photos, wall.input, {depth.depth, torch::ones({3, 70, 69})}}, 10), ShapeError);
}

}  // namespace
}  // namespace oraclegs::vggt
