#include "oraclegs/run/needed_photos.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"
#include "run/fixtures.h"

namespace oraclegs {
namespace {
using testing::ElementsAre;
using testing::HasSubstr;

class NeededPhotosTest : public testing::Test {
 protected:
  /// A run of that many photos without poses.
  oraclegs::Run WithPhotos(int photos, const SplitOptions& split) {
    Scene scene;
    scene.root = temp / "scene";
    for (int i = 0; i < photos; ++i) {
      SceneView view;
      view.name = fmt::format("{:03}.jpg", i);
      scene.views.push_back(view);
    }
    RunOptions options;
    options.split = split;
    return {options,
            "test",
            {},
            Workspace::Claim(temp / "out", temp / "scene", options, true),
            std::move(scene),
            {},
            recorder.AsListener(),
            "of these photos"};
  }

  TempDir temp;
  EventRecorder recorder;
};

TEST_F(NeededPhotosTest, LeavesOutWhatNeitherTrainsNorTests) {
  SplitOptions split;
  split.views = 12;
  split.test_every = 8;
  auto run = WithPhotos(80, split);
  const Split before = SplitViews(run.scene, split);
  const std::vector<std::string> train = NamesAt(run.scene, before.train), test = NamesAt(run.scene, before.test);
  KeepNeededPhotos(&run, run.listener);
  EXPECT_EQ(run.scene.views.size(), 22u);
  EXPECT_THAT(recorder.notes, ElementsAre(HasSubstr("22 of 80 photos are used")));
  const Split after = SplitOfRun(run);
  EXPECT_EQ(NamesAt(run.scene, after.train), train) << "the same split, though positions have changed";
  EXPECT_EQ(NamesAt(run.scene, after.test), test);
  // One that trains and one that tests find no pose.
  std::erase_if(run.scene.views, [&](const SceneView& view) { return view.name == train[3] || view.name == test[0]; });
  EXPECT_EQ(SplitOfRun(run).train.size(), 11u);
  EXPECT_EQ(SplitOfRun(run).test.size(), 9u);
  std::erase_if(run.scene.views, [&](const SceneView& view) { return view.name != train[0]; });
  EXPECT_THROW(SplitOfRun(run), InputError);
}

TEST_F(NeededPhotosTest, KeepsFewPhotosAndAllWhereAllAreAsked) {
  SplitOptions split;
  auto all = WithPhotos(80, split);
  KeepNeededPhotos(&all, all.listener);
  EXPECT_EQ(all.scene.views.size(), 80u);
  EXPECT_FALSE(all.needed.has_value());
}

TEST_F(NeededPhotosTest, KeepsFewPhotos) {
  SplitOptions split;
  split.views = 12;
  auto few = WithPhotos(60, split);
  KeepNeededPhotos(&few, few.listener);
  EXPECT_EQ(few.scene.views.size(), 60u) << "the others help to find poses";
}

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
