#include <algorithm>
#include <cstdlib>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/scene/image.h"
#include "oraclegs/scene/sfm.h"
#include "support/golden.h"
#include "support/textured_planes.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

/// The same photographs, their lenses and poses forgotten.
Scene Unposed(Scene scene) {
  scene.format = SceneFormat::kPhotos;
  for (SceneView& view : scene.views) {
    view.lens = {};
    view.cam_from_world.reset();
  }
  return scene;
}

Scene WithBlackPhotos(const std::filesystem::path& dir) {
  Scene scene = Unposed(WriteTexturedPlanes(dir, 2));
  for (const SceneView& view : scene.views) {
    WritePng(view.image_path, {64, 48, 3, std::vector<uint8_t>(size_t{64} * 48 * 3, 0)});
  }
  return scene;
}

std::string MessageOf(const Scene& scene, const std::filesystem::path& work_dir) {
  try {
    RegisterPhotos(scene, work_dir, Silent());
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

TEST(RegisterPhotos, FindsTheCamerasAndSaysWhichOnesAreMissing) {
  const TempDir dir;
  Scene scene = Unposed(WriteTexturedPlanes(dir / "scene", 5));
  SceneView black = scene.views[0];
  black.name = "9-black.png";
  black.image_path = dir / "scene" / black.name;
  WritePng(black.image_path, {64, 48, 3, std::vector<uint8_t>(size_t{64} * 48 * 3, 0)});
  scene.views.push_back(black);

  std::string said;
  const Listener listener = [&](const Event& event) {
    if (const auto* warning = std::get_if<Warning>(&event)) said += warning->text + "\n";
  };
  const Scene found = RegisterPhotos(scene, dir / "sfm", listener);
  EXPECT_THAT(said, HasSubstr("registered 5 of 6 photographs; not registered: 9-black.png"));
  EXPECT_EQ(found.format, SceneFormat::kColmap);
  ASSERT_EQ(found.views.size(), 5u);
  EXPECT_GT(found.points.size(), 50u);
  for (size_t v = 0; v < 5; ++v) {
    EXPECT_EQ(found.views[v].name, scene.views[v].name);
    EXPECT_EQ(found.views[v].image_path, scene.views[v].image_path);
    EXPECT_EQ(found.views[v].lens.width, kPlanesWidth);
    ASSERT_TRUE(found.views[v].cam_from_world.has_value());
  }
  // The true centres stand at equal steps on a line; the found ones must too, whatever the scale.
  const auto center = [&](size_t v) -> Eigen::Vector3d {
    return found.views[v].cam_from_world->inverse().translation();
  };
  const double length = (center(4) - center(0)).norm();
  for (size_t v = 1; v < 4; ++v) {
    const Eigen::Vector3d want = center(0) + (center(4) - center(0)) * static_cast<double>(v) / 4;
    EXPECT_LT((center(v) - want).norm(), .03 * length) << v;
  }

  const std::string log = ReadFile(dir / "sfm" / "colmap.log");
  EXPECT_EQ(RegisterPhotos(scene, dir / "sfm", Silent()).points.size(), found.points.size());
  EXPECT_EQ(ReadFile(dir / "sfm" / "colmap.log"), log) << "a finished model is read, not made again";
}

TEST(RegisterPhotos, BlackPhotographsAreRefusedByName) {
  const TempDir dir;
  const Scene scene = WithBlackPhotos(dir / "scene");
  EXPECT_THAT(MessageOf(scene, dir / "sfm"),
              AllOf(StartsWith((dir / "scene").string()), HasSubstr("0.png, 1.png"), HasSubstr("overlap")));
}

TEST(RegisterPhotos, WithoutColmapSaysHowToInstallIt) {
  const TempDir dir;
  const Scene scene = WithBlackPhotos(dir / "scene");
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  const std::string message = MessageOf(scene, dir / "sfm");
  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(message, HasSubstr("apt install colmap"));
}

}  // namespace
}  // namespace oraclegs
