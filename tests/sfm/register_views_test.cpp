#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/image.h"
#include "oraclegs/sfm/register_views.h"
#include "support/errors.h"
#include "support/temp_dir.h"
#include "support/textured_planes.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

/// The views of a scene without intrinsics and poses.
Scene Unposed(Scene scene) {
  scene.format = SceneFormat::kPhotos;
  for (SceneView& view : scene.views) {
    view.intrinsics = {};
    view.cam_from_world.reset();
  }
  return scene;
}

Scene WithBlackPhotos(const std::filesystem::path& dir) {
  Scene scene = Unposed(WriteTexturedPlanes(dir, 2));
  uint8_t gray = 0;
  for (const SceneView& view : scene.views) {
    WritePng(view.image_path, {64, 48, 3, std::vector<uint8_t>(size_t{64} * 48 * 3, gray++)});
  }
  return scene;
}

/// A wall of noise seen by a camera that turns about a point and does not move.
Scene WriteTurningCamera(const std::filesystem::path& dir, int views) {
  Scene scene;
  scene.root = dir;
  for (int v = 0; v < views; ++v) {
    SceneView view;
    view.name = std::to_string(v) + ".png";
    view.image_path = dir / "images" / view.name;
    const double s = std::sin(.15 * v), c = std::cos(.15 * v);
    Image8 image{kPlanesWidth, kPlanesHeight, 3, {}};
    for (int y = 0; y < kPlanesHeight; ++y) {
      for (int x = 0; x < kPlanesWidth; ++x) {
        const double a = (x + .5 - kPlanesWidth / 2.) / kPlanesFocal, b = (y + .5 - kPlanesHeight / 2.) / kPlanesFocal;
        const double depth = c - s * a, u = 5 + (c * a + s) / depth, w = 5 + b / depth;
        const double n = .55 * PlaneNoise(u * 40, w * 40, 1) + .45 * PlaneNoise(u * 90, w * 90, 9);
        image.data.insert(image.data.end(), 3, static_cast<uint8_t>(255 * n));
      }
    }
    std::filesystem::create_directories(view.image_path.parent_path());
    WritePng(view.image_path, image);
    scene.views.push_back(std::move(view));
  }
  return scene;
}

std::string ErrorOf(const Scene& scene, const std::filesystem::path& work_dir) {
  return MessageOf<InputError>([&] { RegisterViews(scene, work_dir, Silent()); });
}

TEST(RegisterViews, FindsCamerasAndNamesMissingOnes) {
  const TempDir dir;
  Scene scene = Unposed(WriteTexturedPlanes(dir / "scene", 5));
  SceneView black = scene.views[0];
  black.name = "9-black.png";
  black.image_path = dir / "scene" / black.name;
  WritePng(black.image_path, {64, 48, 3, std::vector<uint8_t>(size_t{64} * 48 * 3, 0)});
  SceneView again = scene.views[1];
  again.name = "8-again.png";
  again.image_path = dir / "scene" / again.name;
  std::filesystem::copy_file(scene.views[1].image_path, again.image_path);
  scene.views.push_back(again);
  scene.views.push_back(black);

  std::string said;
  const Listener listener = [&](const Event& event) {
    if (const auto* warning = std::get_if<Warning>(&event)) said += warning->text + "\n";
  };
  const Scene found = RegisterViews(scene, dir / "sfm", listener);
  EXPECT_THAT(said, HasSubstr("registered 5 of 7 photos; not registered: 8-again.png (the same photo as 1.png), "
                              "9-black.png (0 features"));
  EXPECT_THAT(said, HasSubstr("8-again.png is the same photo as 1.png and is left out"));
  const std::string first = said;
  EXPECT_EQ(found.format, SceneFormat::kColmap);
  ASSERT_EQ(found.views.size(), 5u);
  EXPECT_GT(found.points.size(), 50u);
  for (size_t v = 0; v < 5; ++v) {
    EXPECT_EQ(found.views[v].name, scene.views[v].name);
    EXPECT_EQ(found.views[v].image_path, scene.views[v].image_path);
    EXPECT_EQ(found.views[v].intrinsics.width, kPlanesWidth);
    ASSERT_TRUE(found.views[v].cam_from_world.has_value());
  }
  // The true centers stand at equal steps on a line; the found ones must too, whatever the scale.
  const auto center = [&](size_t v) -> Eigen::Vector3d {
    return found.views[v].cam_from_world->inverse().translation();
  };
  const double length = (center(4) - center(0)).norm();
  for (size_t v = 1; v < 4; ++v) {
    const Eigen::Vector3d want = center(0) + (center(4) - center(0)) * static_cast<double>(v) / 4;
    EXPECT_LT((center(v) - want).norm(), .03 * length) << v;
  }

  const std::string log = ReadFile(dir / "sfm" / "colmap.log");
  const auto report = nlohmann::json::parse(ReadFile(dir / "sfm" / "registration.json"));
  EXPECT_EQ(report.at("registered"), 5);
  EXPECT_EQ(report.at("views").at(0).at("neighbors").at(0).at("name"), "1.png");
  EXPECT_GT(report.at("views").at(0).at("features"), 100);
  EXPECT_GT(report.at("views").at(0).at("parallax_degrees"), 2);
  EXPECT_EQ(report.at("attempts").at(0).at("name"), "strict");
  said.clear();
  EXPECT_EQ(RegisterViews(scene, dir / "sfm", listener).points.size(), found.points.size());
  EXPECT_EQ(said, first) << "a cached result repeats the warnings";
  EXPECT_EQ(ReadFile(dir / "sfm" / "colmap.log"), log) << "a finished model is read, not made again";
}

TEST(RegisterViews, NamesBlackImages) {
  const TempDir dir;
  const Scene scene = WithBlackPhotos(dir / "scene");
  EXPECT_THAT(ErrorOf(scene, dir / "sfm"), AllOf(StartsWith((dir / "scene").string()), HasSubstr("0.png (0 features"),
                                                 HasSubstr("1.png (0 features"), HasSubstr("overlap")));
  const auto report = nlohmann::json::parse(ReadFile(dir / "sfm" / "registration.json"));
  EXPECT_EQ(report.at("registered"), 0);
  EXPECT_EQ(report.at("views").at(0).at("status"), "few_features");
  EXPECT_FALSE(std::filesystem::exists(dir / "sfm" / "inputs.json"));
  const std::string log = ReadFile(dir / "sfm" / "colmap.log"), first = ErrorOf(scene, dir / "sfm");
  EXPECT_THAT(first, HasSubstr("0.png (0 features"));
  EXPECT_EQ(ReadFile(dir / "sfm" / "colmap.log"), log) << "what was in vain is not done again";
}

TEST(RegisterViews, RefusesDuplicates) {
  const TempDir dir;
  Scene scene = Unposed(WriteTexturedPlanes(dir / "scene", 2));
  std::filesystem::copy_file(scene.views[0].image_path, scene.views[1].image_path,
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(ErrorOf(scene, dir / "sfm"), AllOf(StartsWith((dir / "scene").string()), HasSubstr("one and the same"),
                                                 HasSubstr("different places")));
}

TEST(RegisterViews, RefusesPureRotation) {
  const TempDir dir;
  const Scene scene = WriteTurningCamera(dir / "scene", 3);
  EXPECT_THAT(ErrorOf(scene, dir / "sfm"), AllOf(HasSubstr("taken from one point"), HasSubstr("move sideways")));
}

TEST(RegisterViews, SaysHowToInstallColmap) {
  const TempDir dir;
  const Scene scene = WithBlackPhotos(dir / "scene");
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  const std::string message = ErrorOf(scene, dir / "sfm");
  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(message, HasSubstr("apt install colmap"));
}

}  // namespace
}  // namespace oraclegs
