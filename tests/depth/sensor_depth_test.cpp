#include "oraclegs/depth/sensor_depth.h"

#include <gmock/gmock.h>

#include "depth/surfaces.h"
#include "oraclegs/camera/distortion_models.h"
#include "oraclegs/camera/undistort.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/image/codecs.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A slanted plane before a camera, and files of a sensor that sees it.
class SensorDepthTest : public testing::Test {
 protected:
  SensorDepthTest() {
    view_.name = "a.jpg";
    view_.intrinsics = {CameraModel::kPinhole, 64, 48, {60, 60, 32, 24}};
    view_.depth_path = dir_ / "depth.png";
    Look();
  }
  /// The camera that shows the photo without distortion, from four units away.
  void Look() {
    camera_ = UndistortedCamera(view_.intrinsics);
    camera_.cam_from_world = CameraAt({0, 0.2, -4}, {0, 0, 0}, 64, 48).cam_from_world;
  }
  /// Depth of the plane in millimeters, in a picture of width x height with the photo's distortion.
  std::vector<uint16_t> Measured(int width, int height) const {
    const DistortionMap lens(view_.intrinsics);
    std::vector<uint16_t> values;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto ray = lens.Unproject((x + 0.5) * 64 / width, (y + 0.5) * 48 / height);
        const double z =
            kSlanted.DepthAt(camera_, camera_.fx * ray->x() + camera_.cx, camera_.fy * ray->y() + camera_.cy);
        values.push_back(static_cast<uint16_t>(std::lround(1000 * z)));
      }
    }
    return values;
  }
  void Write(int width, int height, const std::vector<uint16_t>& values) const {
    WritePng16(view_.depth_path, width, height, values);
  }
  void WriteConfidence(int width, int height, const std::vector<uint8_t>& levels) {
    view_.confidence_path = dir_ / "confidence.png";
    WritePng(view_.confidence_path, {width, height, 1, levels});
  }
  DepthMap Read(double unit = 1) const { return ReadSensorDepth(view_, camera_, unit); }
  DepthMap Truth() const { return TrueDepth(kSlanted.Take(camera_, "a.jpg"), kSlanted, 1); }

  TempDir dir_;
  SceneView view_;
  Camera camera_;
};

TEST_F(SensorDepthTest, HasDepthsAndNormalsOfTheSurfaceInAnySize) {
  const DepthMap truth = Truth();
  for (const int width : {16, 32, 64, 256}) {
    Write(width, width * 3 / 4, Measured(width, width * 3 / 4));
    const DepthMap read = Read();
    ASSERT_EQ(read.size(), truth.size());
    for (size_t i = 0; i < truth.size(); ++i) {
      ASSERT_NEAR(read.inv_depth[i], truth.inv_depth[i], 1e-3f * truth.inv_depth[i]) << width << " " << i;
      EXPECT_GT(read.normals[i].dot(truth.normals[i]), 0.99f);
      EXPECT_GE(read.confidence[i], kConfident);
    }
    EXPECT_NEAR(Read(2).inv_depth[5], 2 * read.inv_depth[5], 1e-5f) << "units of the camera twice as long";
  }
  view_.depth_unit = 0.002;
  EXPECT_NEAR(Read().inv_depth[5], truth.inv_depth[5] / 2, 1e-3f);
}

TEST_F(SensorDepthTest, IsUndistortedWithThePhoto) {
  view_.intrinsics = {CameraModel::kSimpleRadial, 64, 48, {60, 32, 24, 0.3}};
  Look();
  Write(32, 24, Measured(32, 24));
  const DepthMap truth = Truth(), read = Read();
  for (size_t i = 0; i < truth.size(); ++i) EXPECT_NEAR(read.inv_depth[i], truth.inv_depth[i], 1e-3f) << i;
}

TEST_F(SensorDepthTest, IsUnknownInHolesAndWhereConfidenceIsLow) {
  std::vector<uint16_t> values = Measured(32, 24);
  values[0] = 0, values[40] = 65535;
  Write(32, 24, values);
  for (const int high : {255, 2}) {
    std::vector<uint8_t> levels(32 * 24, static_cast<uint8_t>(high));
    levels[100] = 0, levels[200] = static_cast<uint8_t>(high / 2);
    WriteConfidence(32, 24, levels);
    const DepthMap read = Read();
    const auto at = [](int i) { return static_cast<size_t>((i / 32 * 2) * 64 + i % 32 * 2); };
    for (const int i : {0, 40, 100}) {
      EXPECT_EQ(read.inv_depth[at(i)], 0) << i;
      EXPECT_EQ(read.confidence[at(i)], 0) << i;
      EXPECT_EQ(read.normals[at(i)], Eigen::Vector3f::Zero()) << i;
    }
    EXPECT_GT(read.confidence[at(300)], read.confidence[at(200)]);
    EXPECT_GE(read.confidence[at(200)], kConfident) << "medium";
  }
  view_.confidence_path.clear();
  Write(32, 24, std::vector<uint16_t>(values.size(), 0));
  EXPECT_EQ(ConfidentShare(Read()), 0);
}

TEST_F(SensorDepthTest, SmoothsNoiseButNoEdge) {
  std::vector<uint16_t> values;
  for (int i = 0; i < 64 * 48; ++i) {
    const int noise = (i * 7919) % 41 - 20;  // mm
    values.push_back(static_cast<uint16_t>((i % 64 < 32 ? 2000 : 3000) + noise));
  }
  values[20 * 64 + 31] = 2500;  // a mean of both sides
  Write(64, 48, values);
  const DepthMap read = Read();
  std::vector<float> left, right;
  for (size_t i = 0; i < read.size(); ++i) {
    if (!(read.inv_depth[i] > 0)) continue;
    (i % 64 < 32 ? left : right).push_back(std::abs(1 / read.inv_depth[i] - (i % 64 < 32 ? 2 : 3)));
  }
  EXPECT_GT(left.size() + right.size(), 64u * 48 - 40);
  EXPECT_LT(Median(left), 0.005f) << "of noise whose median is 0.01";
  EXPECT_LT(Median(right), 0.006f);
  EXPECT_EQ(read.inv_depth[20 * 64 + 31], 0) << "on neither side";
  EXPECT_LT(read.confidence[10 * 64 + 31], read.confidence[10 * 64 + 10]) << "beside the edge";
}

TEST_F(SensorDepthTest, RefusesOtherAspectsAndDamage) {
  const auto error = [&] { return MessageOf<InputError>([&] { Read(); }); };
  Write(32, 32, std::vector<uint16_t>(1024, 1000));
  EXPECT_THAT(error(), AllOf(HasSubstr("depth.png: is 32 x 32"), HasSubstr("a.jpg is 64 x 48")));
  Write(32, 24, Measured(32, 24));
  WriteConfidence(24, 32, std::vector<uint8_t>(768, 255));
  EXPECT_THAT(error(), HasSubstr("confidence.png: is 24 x 32"));
  WriteText(view_.depth_path, ReadFile(view_.depth_path).substr(0, 60));
  EXPECT_THAT(error(), HasSubstr("depth.png: "));
}

TEST_F(SensorDepthTest, ViewsWithoutHaveEmptyMaps) {
  Write(32, 24, Measured(32, 24));
  Scene scene;
  scene.views = {view_, view_, view_};
  scene.views[1].depth_path.clear();
  const std::vector<DepthMap> maps = ReadSensorMaps(scene, {2, 1}, {camera_, camera_}, 1);
  EXPECT_EQ(maps[0].inv_depth, Read().inv_depth);
  EXPECT_EQ(maps[1].size(), 0u);
  EXPECT_EQ(maps[1].name, "a.jpg");
}

}  // namespace
}  // namespace oraclegs
