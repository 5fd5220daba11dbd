#include "oraclegs/scene/find_model.h"

#include <unistd.h>

#include "scene/tiny_scenes.h"
#include "support/event_recorder.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class FindModelTest : public ::testing::Test {
 protected:
  void MakePhotos(const std::string& folder, int width = 6) {
    for (const char* name : {"a.png", "b.png", "c.png"}) WriteImage(dir_ / folder / name, width);
  }
  std::optional<ModelPlace> Beside(const SceneReadOptions& options = {}) {
    events_ = {};
    return FindModelBeside(dir_.path(), options, events_.AsListener());
  }

  TempDir dir_;
  EventRecorder events_;
};

TEST_F(FindModelTest, TakesTheUsualPlaces) {
  MakePhotos("images");
  EXPECT_FALSE(FindModel(dir_.path(), {}, events_.AsListener()));
  WriteTinyModel(dir_ / "sparse/0");
  const auto place = FindModel(dir_.path(), {}, events_.AsListener());
  ASSERT_TRUE(place);
  EXPECT_EQ(place->model, dir_ / "sparse/0");
  EXPECT_EQ(place->images, dir_ / "images");
}

TEST_F(FindModelTest, TakesTheOneModelBesideThePhotos) {
  for (const char* model : {"colmap/sparse/0", "distorted/sparse", "a/b/model"}) {
    MakePhotos("images");
    WriteTinyModel(dir_ / model);
    const auto place = Beside();
    ASSERT_TRUE(place) << model;
    EXPECT_EQ(place->model, dir_ / model);
    EXPECT_EQ(place->images, dir_ / "images");
    EXPECT_THAT(events_.notes, ElementsAre(HasSubstr("this COLMAP model has 3 of the 3 photos")));
    fs::remove_all(dir_ / model);
  }
}

TEST_F(FindModelTest, LeavesASmallSceneBesideThePhotosAlone) {
  for (const char* name : {"1", "2", "3", "4", "5", "6", "7"})
    WriteImage(dir_ / "images" / (name + std::string(".png")));
  MakePhotos("backup/images");
  WriteTinyModel(dir_ / "backup/sparse/0");
  EXPECT_FALSE(Beside());
  EXPECT_THAT(events_.warnings, ElementsAre(HasSubstr("the COLMAP model in backup/sparse does not fit the photos")));
  ASSERT_TRUE(Beside({.images = "backup/images"}));
  fs::rename(dir_ / "images", dir_ / "photos");  // where all that lies below the scene's folder counts
  EXPECT_FALSE(Beside());
}

TEST_F(FindModelTest, PassesOverFoldersOfOthers) {
  if (geteuid() == 0) GTEST_SKIP() << "may read everything";
  MakePhotos("images");
  WriteTinyModel(dir_ / "colmap/sparse/0");
  fs::create_directories(dir_ / "lost+found");
  fs::permissions(dir_ / "lost+found", fs::perms::none);
  EXPECT_TRUE(Beside());
  fs::permissions(dir_ / "lost+found", fs::perms::owner_all);
}

TEST_F(FindModelTest, PrefersThePhotosNearestToTheModel) {
  MakePhotos("images");
  MakePhotos("dense/images");
  WriteTinyModel(dir_ / "dense/sparse");
  ASSERT_TRUE(Beside());
  EXPECT_EQ(Beside()->images, dir_ / "dense/images");
}

TEST_F(FindModelTest, TakesTheLargestPieceOfAModel) {
  MakePhotos("images");
  WriteTinyModel(dir_ / "colmap/sparse/0");
  WriteTinyModel(dir_ / "colmap/sparse/1");
  EXPECT_TRUE(Beside());
}

TEST_F(FindModelTest, NamesSeveralThatFit) {
  MakePhotos("images");
  WriteTinyModel(dir_ / "one/sparse/0");
  WriteTinyModel(dir_ / "two/sparse/0");
  EXPECT_FALSE(Beside());
  EXPECT_THAT(events_.warnings,
              ElementsAre(AllOf(HasSubstr("several COLMAP models"), HasSubstr("one/sparse/0, two/sparse/0"))));
}

TEST_F(FindModelTest, NamesOneThatDoesNotFit) {
  MakePhotos("images", 9);  // other cameras
  WriteTinyModel(dir_ / "colmap/sparse/0");
  EXPECT_FALSE(Beside());
  EXPECT_THAT(events_.warnings, ElementsAre(HasSubstr("the COLMAP model in colmap/sparse does not fit the photos")));
  for (int i = 0; i < 9; ++i) WriteImage(dir_ / "images" / ("x" + std::to_string(i) + ".png"));
  MakePhotos("images");  // 3 of 12
  EXPECT_FALSE(Beside());
  WriteText(dir_ / "colmap/sparse/0/images.bin", "damaged");
  EXPECT_FALSE(Beside());
  EXPECT_THAT(events_.warnings, ElementsAre(HasSubstr("does not fit")));
}

TEST_F(FindModelTest, PassesOverResultsAndNamesTransforms) {
  MakePhotos("images");
  WriteTinyModel(dir_ / "out/sfm");
  WriteText(dir_ / "out/stages.json", "{}");
  EXPECT_FALSE(Beside());
  EXPECT_THAT(events_.warnings, IsEmpty());
  WriteText(dir_ / "nerf/transforms.json", "{}");
  EXPECT_FALSE(Beside());
  EXPECT_THAT(events_.warnings, ElementsAre(HasSubstr("nerf/transforms.json may have poses")));
  WriteText(dir_ / "lego/transforms_train.json", "{}");
  EXPECT_FALSE(Beside());
  EXPECT_THAT(events_.warnings, ElementsAre(HasSubstr("lego/transforms_train.json, nerf/transforms.json may have")));
}

}  // namespace
}  // namespace oraclegs
