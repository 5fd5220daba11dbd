#include "oraclegs/scene/fit_cameras.h"

#include "scene/tiny_scenes.h"
#include "support/event_recorder.h"

namespace oraclegs {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class FitCamerasTest : public ::testing::Test {
 protected:
  void Add(const std::string& name, int width, int height, const Intrinsics& camera) {
    WriteImage(dir_ / name, width, height);
    SceneView view;
    view.name = name;
    view.image_path = dir_ / name;
    view.intrinsics = camera;
    view.cam_from_world = Eigen::Isometry3d::Identity();
    scene_.views.push_back(view);
  }
  const Intrinsics& Fitted(size_t view) {
    FitCamerasToImages(&scene_, events_.AsListener());
    return scene_.views[view].intrinsics;
  }

  TempDir dir_;
  Scene scene_;
  EventRecorder events_;
};

TEST_F(FitCamerasTest, ScalesEachCameraToItsImage) {
  Add("a.png", 24, 18, {CameraModel::kPinhole, 48, 36, {44, 42, 23, 18}});
  Add("b.png", 30, 20, {CameraModel::kSimpleRadial, 15, 10, {12, 7, 5, 0.1}});
  Add("c.png", 12, 12, {CameraModel::kPinhole, 12, 12, {10, 10, 6, 6}});
  EXPECT_THAT(Fitted(0).params, ElementsAre(22, 21, 11.5, 9));
  EXPECT_EQ(scene_.views[0].intrinsics.width, 24);
  EXPECT_EQ(scene_.views[1].intrinsics.model, CameraModel::kOpenCv);  // with the same coefficients
  EXPECT_THAT(scene_.views[1].intrinsics.params, ElementsAre(24, 24, 14, 10, 0.1, 0, 0, 0));
  EXPECT_THAT(scene_.views[2].intrinsics.params, ElementsAre(10, 10, 6, 6));
  EXPECT_THAT(events_.notes, ElementsAre(HasSubstr(": 2 of 3 photos have another size than their cameras (a.png "
                                                   "is 24 x 18 and its camera 48 x 36)")));
}

TEST_F(FitCamerasTest, LeavesOtherAspectsToWhoLoadsThem) {
  Add("a.png", 24, 19, {CameraModel::kPinhole, 48, 36, {44, 44, 24, 18}});
  Add("b.png", 48, 35, {CameraModel::kPinhole, 48, 36, {44, 44, 24, 18}});  // cropped, not scaled
  EXPECT_EQ(Fitted(0).width, 48);
  EXPECT_EQ(scene_.views[1].intrinsics.height, 36);
  EXPECT_THAT(events_.notes, IsEmpty());
}

TEST_F(FitCamerasTest, WarnsOfCamerasOfAnotherSizeThatDoNotSayIt) {
  Add("a.png", 24, 18, {CameraModel::kPinhole, 24, 18, {44, 44, 24, 18}});
  Add("b.png", 24, 18, {CameraModel::kPinhole, 24, 18, {22, 22, 14, 7}});
  Fitted(0);
  EXPECT_THAT(events_.warnings,
              ElementsAre(HasSubstr("1 of 2 cameras have their principal point far from the middle, "
                                    "e.g. a.png at (24, 18) of 24 x 18 pixels, as if made for images 2 "
                                    "times as large")));
}

TEST_F(FitCamerasTest, AcceptsRoundedSides) {
  EXPECT_TRUE(HaveSameAspect(648, 420, 1297, 840));
  EXPECT_TRUE(HaveSameAspect(649, 420, 1297, 840));
  EXPECT_FALSE(HaveSameAspect(640, 480, 1280, 720));
  EXPECT_FALSE(HaveSameAspect(480, 640, 1280, 960));
}

}  // namespace
}  // namespace oraclegs
