#include "oraclegs/capture/cut_spheres.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
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
    EXPECT_EQ(image.data, CutFace(photo, std::nullopt, turn, FaceIntrinsics(128), SphereFilter::kBicubic).data)
        << view.name;
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

TEST_F(CutSpheresTest, MasksWhatAFisheyePhotoDoesNotShow) {
  Image8 photo = SmoothImage(160, 160, 3), mask{80, 80, 1, std::vector<uint8_t>(80 * 80, 1)};
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 160; ++x) {
      if (std::hypot(x - 79.5, y - 79.5) >= 79.5) std::fill_n(photo.data.begin() + 3 * (160 * y + x), 3, uint8_t{0});
    }
  }
  std::fill_n(mask.data.begin() + 80 * 70, 80 * 10, uint8_t{0});  // the photographer, below
  WritePng(dir_ / "scene/a.png", photo);
  WritePng(dir_ / "scene/mask.png", mask);
  const auto read = [&](double k1, bool with_mask) {
    Scene scene;
    scene.format = SceneFormat::kColmap;
    scene.views.resize(1);
    SceneView& view = scene.views[0];
    view.name = "a.png", view.image_path = dir_ / "scene/a.png";
    view.intrinsics = {CameraModel::kOpenCvFisheye, 160, 160, {48, 48, 80, 80, k1, 0, 0, 0}};
    view.cam_from_world = Eigen::Isometry3d::Identity();
    if (with_mask) view.mask_path = dir_ / "scene/mask.png", view.mask_white = 1;
    TakeFaces(dir_ / "faces", Silent(), &scene);
    CutSpheres(scene, dir_ / "faces", events_.AsListener());
    return scene;
  };
  std::map<std::string, int64_t> kept;
  for (const bool with_mask : {false, true}) {
    for (const SceneView& view : read(0, with_mask).views) {
      const Image8 image = ReadImage(view.image_path), shown = ReadImage(view.mask_path);
      ASSERT_EQ(image.width, view.intrinsics.width);
      ASSERT_EQ(shown.data.size(), image.data.size());
      int64_t white = 0, black_kept = 0;
      for (size_t i = 0; i < image.data.size(); i += 3) {
        const bool is_kept = shown.data[i] == 255;
        white += is_kept, black_kept += is_kept && image.data[i] + image.data[i + 1] + image.data[i + 2] < 30;
      }
      EXPECT_EQ(black_kept, 0) << view.name << ": no black corner is trained";
      EXPECT_GT(white, 1000) << view.name;
      if (with_mask) {
        const bool is_beside = view.name != "a_up.png" && view.name != "a_front.png";  // he stands 72 degrees down
        EXPECT_EQ(white < kept[view.name], is_beside) << view.name;
      } else {
        kept[view.name] = white;
      }
    }
  }
  EXPECT_THAT(kept, SizeIs(5));
  const auto json = nlohmann::json::parse(ReadFile(dir_ / "faces/faces.json"))["spheres"][0];
  EXPECT_EQ(json["lens"]["model"], "OPENCV_FISHEYE");
  EXPECT_EQ(json["faces"][1]["camera"]["params"].size(), 4u);
  EXPECT_THAT(events_.started, SizeIs(2));
  read(0, true);
  EXPECT_THAT(events_.started, SizeIs(2)) << "the same";
  read(.01, true);
  EXPECT_THAT(events_.started, SizeIs(3)) << "another lens";
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
