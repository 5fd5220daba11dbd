#include "oraclegs/run/photo_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "run/fixtures.h"

namespace oraclegs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class PhotoReportTest : public testing::Test {
 protected:
  PhotoReportTest() {
    MakeTinyScene(temp / "scene");
    photos = temp / "scene" / "images";
    std::filesystem::resize_file(photos / "002.png", std::filesystem::file_size(photos / "002.png") / 2);
  }

  /// A run of plain photos that has not been registered.
  oraclegs::Run Unregistered() {
    Scene scene;
    scene.root = photos;
    for (const auto& entry : std::filesystem::directory_iterator(photos)) {
      SceneView view;
      view.name = entry.path().filename().string();
      view.image_path = entry.path();
      scene.views.push_back(view);
    }
    return {{},
            "test",
            {},
            Workspace::Claim(temp / "out", photos, {}, false),
            std::move(scene),
            {},
            recorder.AsListener(),
            "of these photos"};
  }

  TempDir temp;
  std::filesystem::path photos;
  EventRecorder recorder;
};

TEST_F(PhotoReportTest, LeavesOutTheSamePhotosAgain) {
  size_t before = 0;
  {
    auto run = Unregistered();
    before = run.scene.views.size();
    CheckRunPhotos(&run);
    EXPECT_EQ(run.scene.views.size(), before - 1);
  }
  EXPECT_THAT(recorder.warnings, testing::Contains(HasSubstr("002.png")));
  const size_t said = recorder.warnings.size();
  {
    auto run = Unregistered();
    LeaveOutUnreadablePhotos(&run);
    EXPECT_EQ(run.scene.views.size(), before - 1);
    EXPECT_EQ(recorder.warnings.size(), said) << "a run that is opened says nothing";
  }
  auto run = Unregistered();
  CheckRunPhotos(&run);
  EXPECT_EQ(recorder.warnings.size(), 2 * said);
  EXPECT_EQ(run.scene.views.size(), before - 1);
}

TEST_F(PhotoReportTest, LooksAnewAtOtherPhotos) {
  {
    auto run = Unregistered();
    CheckRunPhotos(&run);
  }
  auto run = Unregistered();
  run.photos = "of others";
  const size_t before = run.scene.views.size();
  LeaveOutUnreadablePhotos(&run);
  EXPECT_EQ(run.scene.views.size(), before) << "what is kept is of others";
  CheckRunPhotos(&run);
  EXPECT_EQ(run.scene.views.size(), before - 1);
  EXPECT_THAT(ReadFile(run.workspace.photo_checks()), HasSubstr("of others"));
}

TEST_F(PhotoReportTest, IgnoresAScenesOwnPoses) {
  auto run = Unregistered();
  run.photos.clear();
  CheckRunPhotos(&run);
  EXPECT_TRUE(recorder.warnings.empty());
}

}  // namespace
}  // namespace oraclegs
