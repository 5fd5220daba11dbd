#include "oraclegs/capture/cut_spheres.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "image/jpeg_files.h"
#include "oraclegs/camera/sphere_faces.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/read_image.h"
#include "oraclegs/scene/spheres.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class CutSpheresTest : public ::testing::Test {
 protected:
  void SetUp() override {
    WriteText(dir_ / "scene/a.jpg", EncodeJpeg(SmoothImage(128, 64, 3)));
    WritePng(dir_ / "scene/b.png", SmoothImage(128, 64, 4));
    Image8 mask{64, 32, 1, std::vector<uint8_t>(64 * 32, 255)};
    for (size_t i = 64 * 28; i < mask.data.size(); ++i) mask.data[i] = 0;
    WritePng(dir_ / "scene/mask.png", mask);
  }

  Scene Read() const {
    Scene scene;
    scene.root = dir_ / "scene";
    for (const char* name : {"a.jpg", "b.png"}) {
      SceneView view;
      view.name = name;
      view.image_path = scene.root / name;
      view.is_sphere = true;
      if (view.name == "b.png") view.mask_path = scene.root / "mask.png";
      scene.views.push_back(std::move(view));
    }
    TakeFaces(dir_ / "faces", Silent(), &scene);
    return scene;
  }
  void Cut() { CutSpheres(Read(), dir_ / "faces", events_.AsListener()); }

  TempDir dir_;
  EventRecorder events_;
};

TEST_F(CutSpheresTest, WritesImagesAndMasks) {
  Cut();
  const Image8 photo = ReadImage(dir_ / "scene/b.png");
  std::set<fs::path> files;
  for (const SceneView& view : Read().views) {
    const Image8 image = ReadImage(view.image_path);
    ASSERT_EQ(image.width, view.intrinsics.width);
    files.insert(view.image_path);
    if (view.mask_path.empty()) continue;
    const Eigen::Matrix3d& turn = SphereFaces()[static_cast<size_t>(view.sphere->face)].face_from_sphere;
    EXPECT_EQ(image.data, CutFace(photo, turn, FaceIntrinsics(128), SphereFilter::kBicubic).data) << view.name;
    const Image8 mask = ReadImage(view.mask_path);
    EXPECT_EQ(mask.width, image.width);
    const auto black = std::count(mask.data.begin(), mask.data.end(), 0);
    EXPECT_EQ(black > 0, view.sphere->face == 5) << view.name << ": the tripod is below";
  }
  EXPECT_THAT(files, SizeIs(12));
  EXPECT_TRUE(files.count(dir_ / "faces" / "images" / "a_front.jpg"));
  const auto json = nlohmann::json::parse(ReadFile(dir_ / "faces/faces.json"));
  EXPECT_EQ(json["spheres"][0]["photo"], "a.jpg");
  EXPECT_EQ(json["spheres"][0]["faces"][2]["image"], "a_front.jpg");
  EXPECT_EQ(json["spheres"][0]["faces"][2]["face_from_sphere"], nlohmann::json({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_THAT(events_.started, ElementsAre("import"));
  EXPECT_FALSE(fs::exists(dir_ / ".oraclegs-faces.tmp"));
}

TEST_F(CutSpheresTest, KeepsWhatIsWhole) {
  Cut(), Cut();
  EXPECT_THAT(events_.started, SizeIs(1)) << "once";
  fs::remove(dir_ / "faces/masks/b_up.png.png");
  Cut();
  EXPECT_THAT(events_.started, SizeIs(2));
  EXPECT_TRUE(fs::exists(dir_ / "faces/masks/b_up.png.png"));
  WritePng(dir_ / "scene/b.png", SmoothImage(64, 32, 3));
  WriteText(dir_ / "faces/images/old.jpg", "x");
  Cut();
  EXPECT_THAT(events_.started, SizeIs(3)) << "another photo";
  EXPECT_FALSE(fs::exists(dir_ / "faces/images/old.jpg"));
  WriteText(dir_ / "faces/faces.json", "{");
  Cut();
  EXPECT_THAT(events_.started, SizeIs(4));
}

TEST_F(CutSpheresTest, DoesNothingWithoutSpheres) {
  Scene scene;
  scene.views.resize(2);
  CutSpheres(scene, dir_ / "faces", events_.AsListener());
  EXPECT_FALSE(fs::exists(dir_ / "faces"));
  EXPECT_THAT(events_.started, IsEmpty());
}

TEST_F(CutSpheresTest, NamesAPhotoThatCannotBeDecoded) {
  const Scene scene = Read();
  fs::resize_file(dir_ / "scene/b.png", fs::file_size(dir_ / "scene/b.png") / 2);
  EXPECT_THAT(MessageOf<InputError>([&] { CutSpheres(scene, dir_ / "faces", Silent()); }), HasSubstr("b.png"));
  EXPECT_FALSE(fs::exists(dir_ / "faces")) << "nothing half made";
  EXPECT_FALSE(fs::exists(dir_ / ".oraclegs-faces.tmp"));
}

}  // namespace
}  // namespace oraclegs
