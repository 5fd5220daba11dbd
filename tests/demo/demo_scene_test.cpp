#include "oraclegs/demo/demo_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/image.h"
#include "oraclegs/image/read_image.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr DemoSceneOptions kTiny{3, 48, 36, 1};

std::map<std::string, std::string> FilesOf(const fs::path& dir) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(dir)) {
    if (entry.is_regular_file()) files[fs::relative(entry.path(), dir).string()] = ReadFile(entry.path());
  }
  return files;
}

nlohmann::json Transforms(const fs::path& dir) { return nlohmann::json::parse(ReadFile(dir / "transforms.json")); }

TEST(WriteDemoScene, WritesSameBytesForAnyThreads) {
  const TempDir dir;
  const int before = NumThreads();
  SetNumThreads(1);
  WriteDemoScene(dir / "one", kTiny, Silent());
  SetNumThreads(4);
  WriteDemoScene(dir / "four", kTiny, Silent());
  SetNumThreads(before);
  const auto files = FilesOf(dir / "one");
  EXPECT_EQ(files.size(), 2u + 3 + 3);
  EXPECT_TRUE(files == FilesOf(dir / "four"));
}

TEST(WriteDemoScene, WritesTheKind) {
  const TempDir dir;
  DemoSceneOptions options = kTiny;
  options.kind = DemoKind::kObject;
  WriteDemoScene(dir / "demo", options, Silent());
  EXPECT_EQ(nlohmann::json::parse(ReadFile(dir / "demo" / "demo_scene.json"))["kind"], "object");
  const Image8 image = ReadImage(dir / "demo" / "images" / "000.png");
  EXPECT_EQ(image.data.front(), 255);
  EXPECT_EQ(ReadPng16(dir / "demo" / "depth" / "000.png").values.front(), 0);
}

TEST(WriteDemoScene, NamesDepthOfASensorAndNeverTheTruth) {
  const TempDir dir;
  DemoSceneOptions options = kTiny;
  options.sensor = true;
  WriteDemoScene(dir / "demo", options, Silent());
  const nlohmann::json frame = Transforms(dir / "demo")["frames"][1];
  EXPECT_EQ(frame["depth_file_path"], "sensor/001.png");
  EXPECT_EQ(frame["confidence_file_path"], "sensor_confidence/001.png");
  EXPECT_EQ(ReadPng16(dir / "demo" / "sensor/001.png").width, 24);
  EXPECT_EQ(ReadImage(dir / "demo" / "sensor_confidence/001.png").height, 18);
  WriteDemoScene(dir / "demo", kTiny, Silent());
  EXPECT_FALSE(fs::exists(dir / "demo" / "sensor/001.png"));
  EXPECT_FALSE(Transforms(dir / "demo")["frames"][1].contains("depth_file_path"));
}

TEST(WriteDemoScene, HasNoSensorForSpheres) {
  const TempDir dir;
  DemoSceneOptions options = kTiny;
  options.sensor = true;
  options.kind = DemoKind::kSpheres;
  EXPECT_THROW(WriteDemoScene(dir / "demo", options, Silent()), UsageError);
  EXPECT_FALSE(fs::exists(dir / "demo"));
}

TEST(WriteDemoScene, WritesRequestedPosesAndIntrinsics) {
  const TempDir dir;
  WriteDemoScene(dir / "demo", kTiny, Silent());
  const nlohmann::json json = Transforms(dir / "demo");
  EXPECT_EQ(json["w"], 48);
  EXPECT_EQ(json["h"], 36);
  EXPECT_DOUBLE_EQ(json["fl_x"], .92 * 48);
  EXPECT_DOUBLE_EQ(json["fl_y"], .92 * 48);
  EXPECT_DOUBLE_EQ(json["cx"], 24);
  EXPECT_DOUBLE_EQ(json["cy"], 18);
  ASSERT_EQ(json["frames"].size(), 3u);
  // Azimuths -60, 0 and 60 degrees about the target; radius 2.95 + 0.2 sin(3 pi i / (n-1)); heights 1.05 and 1.75.
  const Eigen::Vector3d target(.02, .05, .6);
  const std::array<double, 3> azimuth{-M_PI / 3, 0, M_PI / 3}, radius{2.95, 2.75, 2.95}, height{1.05, 1.75, 1.05};
  for (int i = 0; i < 3; ++i) {
    Eigen::Matrix4d m;
    for (int k = 0; k < 16; ++k) m(k / 4, k % 4) = json["frames"][i]["transform_matrix"][k / 4][k % 4];
    const Eigen::Matrix3d r = m.topLeftCorner<3, 3>();
    EXPECT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(r.determinant(), 1, 1e-12);
    const Eigen::Vector3d center = m.topRightCorner<3, 1>();
    const Eigen::Vector3d want(target.x() + radius[i] * std::sin(azimuth[i]),
                               target.y() - radius[i] * std::cos(azimuth[i]), height[i]);
    EXPECT_LT((center - want).norm(), 1e-12) << i;
    EXPECT_LT((r.col(2) - (center - target).normalized()).norm(), 1e-12) << "z points backward, away from the target";
    EXPECT_NEAR(r(2, 0), 0, 1e-12) << "the camera is level";
    EXPECT_GT(r(2, 1), 0) << "y points up";
  }
}

TEST(WriteDemoScene, WritesImagesOfRequestedSize) {
  const TempDir dir;
  WriteDemoScene(dir / "demo", kTiny, Silent());
  const Image8 image = ReadImage(dir / "demo" / "images" / "002.png");
  EXPECT_EQ(image.width, 48);
  EXPECT_EQ(image.height, 36);
  EXPECT_EQ(image.channels, 3);
  int width = 0, height = 0;
  ReadImageSize(dir / "demo" / "depth" / "002.png", &width, &height);
  EXPECT_EQ(width, 48);
  EXPECT_EQ(height, 36);
}

TEST(WriteDemoScene, ReplacesFormerDemoScene) {
  const TempDir dir;
  DemoSceneOptions more = kTiny;
  more.views = 5;
  WriteDemoScene(dir / "demo", more, Silent());
  std::ofstream(dir / "demo" / "notes.txt") << "mine";
  WriteDemoScene(dir / "demo", kTiny, Silent());
  EXPECT_FALSE(fs::exists(dir / "demo" / "images" / "003.png"));
  EXPECT_FALSE(fs::exists(dir / "demo" / "depth" / "004.png"));
  EXPECT_EQ(ReadFile(dir / "demo" / "notes.txt"), "mine");
  EXPECT_EQ(Transforms(dir / "demo")["frames"].size(), 3u);
}

TEST(WriteDemoScene, RefusesFolderWithOtherFiles) {
  const TempDir dir;
  fs::create_directories(dir / "photos" / "images");
  std::ofstream(dir / "photos" / "images" / "000.png") << "precious";
  EXPECT_THROW(WriteDemoScene(dir / "photos", kTiny, Silent()), RunError);
  EXPECT_EQ(ReadFile(dir / "photos" / "images" / "000.png"), "precious");
  EXPECT_FALSE(fs::exists(dir / "photos" / "transforms.json"));
  std::ofstream(dir / "file") << "x";
  EXPECT_THROW(WriteDemoScene(dir / "file", kTiny, Silent()), RunError);
  fs::create_directories(dir / "empty");
  EXPECT_NO_THROW(WriteDemoScene(dir / "empty", kTiny, Silent()));
}

TEST(WriteDemoScene, RefusesOptionsOutOfRange) {
  const TempDir dir;
  DemoSceneOptions options = kTiny;
  options.views = 1;
  EXPECT_THROW(WriteDemoScene(dir / "demo", options, Silent()), UsageError);
  EXPECT_FALSE(fs::exists(dir / "demo"));
}

TEST(WriteDemoScene, LeavesNoTransformsWhenInterrupted) {
  const TempDir dir;
  const Listener stop_after_one = [](const Event& event) {
    if (std::holds_alternative<StepDone>(event)) RequestInterrupt(true);
  };
  EXPECT_THROW(WriteDemoScene(dir / "demo", kTiny, stop_after_one), Interrupted);
  RequestInterrupt(false);
  EXPECT_FALSE(fs::exists(dir / "demo" / "transforms.json"));
  WriteDemoScene(dir / "demo", kTiny, Silent());
  EXPECT_TRUE(fs::exists(dir / "demo" / "transforms.json"));
}

}  // namespace
}  // namespace oraclegs
