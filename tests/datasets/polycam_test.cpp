#include "oraclegs/datasets/polycam.h"

#include <nlohmann/json.hpp>

#include "datasets/posed_folder.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::SizeIs;

json PolycamCamera(const SceneView& view) {
  const Eigen::Matrix4d flip = Eigen::Vector4d(1, -1, -1, 1).asDiagonal();
  const Eigen::Matrix4d m = view.cam_from_world->inverse().matrix() * flip;
  const Intrinsics& lens = view.intrinsics;
  json camera = {{"fx", lens.fx()},     {"fy", lens.fy()},       {"cx", lens.cx()},   {"cy", lens.cy()},
                 {"width", lens.width}, {"height", lens.height}, {"blur_score", 90.0}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) camera[fmt::format("t_{}{}", i, j)] = m(i, j);
  }
  return camera;
}

class PolycamTest : public PosedFolder {
 protected:
  void WriteCameras(const fs::path& folder) {
    for (const SceneView& view : truth_) {
      WriteText(folder / fs::path(view.name).replace_extension(".json"), PolycamCamera(view).dump());
    }
  }
};

TEST_F(PolycamTest, ReadsTrueCamerasOfEveryLayout) {
  const struct {
    const char *images, *cameras, *other;
  } layouts[] = {{"keyframes/images", "keyframes/cameras", "keyframes/depth"},
                 {"keyframes/corrected_images", "keyframes/corrected_cameras", "keyframes/cameras"},
                 {"corrected_images", "corrected_cameras", "cameras"},
                 {"images", "cameras", "confidence"}};
  const fs::path photos = dir_ / "photos";
  fs::rename(root() / "images", photos);
  for (const auto& layout : layouts) {
    fs::create_directories(root() / layout.other);
    fs::copy(photos, root() / layout.images, fs::copy_options::recursive);
    WriteCameras(root() / layout.cameras);
    const Scene scene = Read();
    EXPECT_EQ(scene.format, SceneFormat::kPolycam) << layout.images;
    ExpectTruth(scene);
    fs::remove_all(root());
  }
  EXPECT_THAT(events_.notes, Contains(HasSubstr("is read as Polycam's raw export: 3 views")));
}

TEST_F(PolycamTest, LeavesOutImagesWithoutACamera) {
  fs::create_directories(root() / "confidence");
  WriteCameras(root() / "cameras");
  fs::remove(root() / "cameras/001.json");
  EXPECT_THAT(Read().views, SizeIs(2));
  EXPECT_THAT(events_.warnings, Contains(HasSubstr("has no pose for 1 photo and leaves it out: 001.png")));
}

TEST_F(PolycamTest, FindsDepthWithItsConfidence) {
  WriteCameras(root() / "keyframes/cameras");
  fs::rename(root() / "images", root() / "keyframes/images");
  for (const char* name : {"depth/000.png", "depth/001.png", "confidence/001.png"}) {
    WriteText(root() / "keyframes" / name, "not looked at");
  }
  const Scene scene = Read();
  EXPECT_EQ(scene.views[0].depth_path, "") << "nobody knows what of it to trust";
  EXPECT_EQ(scene.views[1].depth_path, root() / "keyframes/depth/001.png");
  EXPECT_EQ(scene.views[1].confidence_path, root() / "keyframes/confidence/001.png");
  EXPECT_EQ(scene.views[1].depth_unit, 1e-3);
  EXPECT_EQ(scene.views[2].depth_path, "");
  fs::remove_all(root() / "keyframes/confidence");
  EXPECT_EQ(Read().views[0].depth_path, root() / "keyframes/depth/000.png") << "an export without any";
}

TEST_F(PolycamTest, SaysWhichCameraIsWrong) {
  fs::create_directories(root() / "confidence");
  WriteCameras(root() / "cameras");
  json camera = PolycamCamera(truth_[0]);
  camera.erase("t_12");
  WriteText(root() / "cameras/000.json", camera.dump());
  EXPECT_THAT(ReadError(), HasSubstr("cameras/000.json: \"transform_matrix\" is not a finite number"));
  camera = PolycamCamera(truth_[0]);
  camera.erase("fx");
  camera.erase("fy");
  WriteText(root() / "cameras/000.json", camera.dump());
  EXPECT_THAT(ReadError(), HasSubstr("000.json: no focal length"));
  WriteText(root() / "cameras/000.json", "[1]");
  EXPECT_THAT(ReadError(), HasSubstr("000.json: is no camera of Polycam"));
  WriteText(root() / "cameras/000.json", "{");
  EXPECT_THAT(ReadError(), HasSubstr("000.json: is not valid JSON"));
}

}  // namespace
}  // namespace oraclegs
