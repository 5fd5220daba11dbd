#include "oraclegs/datasets/dataset_images.h"

#include "datasets/posed_folder.h"

namespace oraclegs {
namespace {

using ::testing::ElementsAre;

TEST(SortedImages, SortsByBytesAndPassesOthersOver) {
  TempDir temp;
  for (const char* name : {"a10.png", "a2.png", "B.png", ".c.png", "below/d.png"}) WriteImage(temp / name);
  WriteText(temp / "notes.txt", "");
  EXPECT_THAT(SortedImages(temp.path()), ElementsAre(temp / "B.png", temp / "a10.png", temp / "a2.png"));
}

TEST(DatasetImageFolder, TakesTheUsualFolderThenTheLargestCopiesThenTheRoot) {
  TempDir temp;
  EXPECT_EQ(DatasetImageFolder(temp.path(), {}), temp.path());
  for (const char* name : {"images_16", "images_4", "images_04x"}) std::filesystem::create_directories(temp / name);
  EXPECT_EQ(DatasetImageFolder(temp.path(), {}), temp / "images_4");
  std::filesystem::create_directories(temp / "images");
  EXPECT_EQ(DatasetImageFolder(temp.path(), {}), temp / "images");
  EXPECT_EQ(DatasetImageFolder(temp.path(), {}, {"image"}), temp / "images_4");
  EXPECT_EQ(DatasetImageFolder(temp.path(), {.images = "other"}), temp / "other");
}

TEST(ViewsOfNames, AddsExtensionsAndFindsImagesBelow) {
  TempDir temp;
  for (const char* name : {"a.png", "below/b.png"}) WriteImage(temp / name);
  const std::vector<SceneView> views = ViewsOfNames({"a", "D:\\photos\\b.JPG", "c"}, "FILE", temp.path(), {}, Silent());
  EXPECT_EQ(views[0].name, "a.png");
  EXPECT_EQ(views[0].image_path, temp / "a.png");
  EXPECT_EQ(views[1].image_path, temp / "below/b.png");
  EXPECT_TRUE(views[2].image_path.empty());
}

}  // namespace
}  // namespace oraclegs
