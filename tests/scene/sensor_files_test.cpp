#include "oraclegs/scene/sensor_files.h"

#include <gmock/gmock.h>

#include "oraclegs/image/codecs.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class SensorFilesTest : public testing::Test {
 protected:
  SensorFilesTest() {
    for (const char* name : {"a.jpg", "b.jpg", "c.jpg"}) {
      SceneView view;
      view.name = name;
      view.intrinsics = {CameraModel::kPinhole, 40, 30, {40, 40, 20, 15}};
      scene_.views.push_back(view);
    }
  }
  void Depth(size_t v, int width, int height) {
    scene_.views[v].depth_path = dir_ / "depth.png";
    WritePng16(dir_ / "depth.png", width, height, std::vector<uint16_t>(static_cast<size_t>(width * height), 900));
  }
  std::string Error() const {
    return MessageOf<InputError>([&] { CheckSensorFiles(scene_); });
  }

  TempDir dir_;
  Scene scene_;
};

TEST_F(SensorFilesTest, AreOfMostViewsFromHalfOn) {
  EXPECT_EQ(SensorDepthOf(scene_), SensorDepth::kNone);
  EXPECT_EQ(SensorDepthOf({}), SensorDepth::kNone);
  Depth(0, 8, 6);
  EXPECT_EQ(SensorDepthOf(scene_), SensorDepth::kSome);
  Depth(2, 8, 6);
  EXPECT_EQ(SensorDepthOf(scene_), SensorDepth::kMost);
  EXPECT_EQ(CountSensorDepth(scene_), 2u);
}

TEST_F(SensorFilesTest, MayHaveAnySizeOfThePhotosAspect) {
  Depth(0, 8, 6);
  CheckSensorFiles(scene_);
  Depth(0, 80, 60);
  CheckSensorFiles(scene_);
  Depth(0, 6, 8);
  EXPECT_THAT(Error(), AllOf(HasSubstr("depth.png: is 6 x 8"), HasSubstr("a.jpg (40 x 30)"), HasSubstr("stereo")));
}

TEST_F(SensorFilesTest, AreGrayOf16Bits) {
  Depth(1, 8, 6);
  WritePng(dir_ / "depth.png", {8, 6, 1, std::vector<uint8_t>(48, 9)});
  EXPECT_THAT(Error(), AllOf(HasSubstr("depth.png: is no gray PNG of 16 bits"), HasSubstr("b.jpg")));
  WriteText(dir_ / "depth.png", "no picture");
  EXPECT_THAT(Error(), HasSubstr("is no gray PNG of 16 bits"));
}

TEST_F(SensorFilesTest, ConfidenceHasTheAspectToo) {
  Depth(0, 8, 6);
  scene_.views[0].confidence_path = dir_ / "confidence.png";
  WritePng(dir_ / "confidence.png", {16, 12, 1, std::vector<uint8_t>(192, 255)});
  CheckSensorFiles(scene_);
  WritePng(dir_ / "confidence.png", {8, 7, 1, std::vector<uint8_t>(56, 255)});
  EXPECT_THAT(Error(), HasSubstr("confidence.png: is 8 x 7"));
}

}  // namespace
}  // namespace oraclegs
