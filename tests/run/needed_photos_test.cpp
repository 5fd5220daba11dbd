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

}  // namespace
}  // namespace oraclegs
