#include "oraclegs/propose/folder_layout.h"

#include "propose/proposal_folders.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using FolderLayoutTest = ProposalFolderTest;

TEST_F(FolderLayoutTest, ReadsImagesWithPoses) {
  WriteFrames({"a", "b"});
  Paint("a.png", {10, 20, 30});
  Paint("b.png", {10, 20, 30});
  const FolderContent content = FindFolderImages(dir_.path(), request_);
  ASSERT_EQ(content.images.size(), 2u);
  EXPECT_EQ(content.images[1].file, dir_ / "b.png");
  EXPECT_TRUE(content.images[1].confidence.empty());
  EXPECT_TRUE(content.images[1].camera.Center().isApprox(Eigen::Vector3d(5, 0.1, 2), 1e-9));
  EXPECT_THAT(content.skipped, IsEmpty());
}

TEST_F(FolderLayoutTest, FindsSyntheticFolderFromParent) {
  Paint("synthetic_12/1.png", {1, 2, 3});
  Paint("synthetic_12/images_3.png", {1, 2, 3});
  Paint("synthetic_12_attention_maps/3.png", {9});
  Paint("synthetic_12_attention_maps/1.png", {9});
  for (const char* below : {"", "synthetic_12", "synthetic_12/", "synthetic_12/../synthetic_12/."}) {
    const FolderContent content = FindFolderImages(dir_.path() / below, request_);
    ASSERT_EQ(content.images.size(), 2u) << below;
    EXPECT_EQ(content.images[0].confidence.filename(), "1.png");
    EXPECT_TRUE(content.images[1].confidence.empty());  // images_3 is not 3
    EXPECT_TRUE(content.images[0].camera.cam_from_world.isApprox(request_.dataset[0].camera.cam_from_world));
    EXPECT_TRUE(content.images[1].camera.cam_from_world.isApprox(request_.dataset[2].camera.cam_from_world));
  }
}

TEST_F(FolderLayoutTest, RefusesWrongFolders) {
  EXPECT_THAT(ErrorOf("no"), HasSubstr("no: is not a folder; give the one that holds the proposals"));
  EXPECT_THAT(ErrorOf(), HasSubstr("has no images; give a folder with images and transforms.json, or synthetic_N"));
  Paint("1.png", {1, 2, 3});
  EXPECT_THAT(ErrorOf(), HasSubstr("has images but no transforms.json"));
  EXPECT_THAT(ErrorOf("1.png"), HasSubstr("is not a folder"));
  std::filesystem::create_directories(dir_ / "synthetic_1");
  EXPECT_THAT(ErrorOf(), HasSubstr("synthetic_1: has no images; put the proposals there"));
  std::filesystem::create_directories(dir_ / "synthetic_2");
  EXPECT_THAT(ErrorOf(), HasSubstr("has several folders of proposals, synthetic_1, synthetic_2; name one of them"));
}

TEST_F(FolderLayoutTest, SkipsNamesOfNoView) {
  Paint("synthetic_3/1.png", {1, 2, 3});
  Paint("synthetic_3/77.png", {1, 2, 3});
  Paint("synthetic_3/78.png", {1, 2, 3});
  EXPECT_THAT(NamesOf(Read()), ElementsAre("1"));
  EXPECT_THAT(events_.warnings, ElementsAre(AllOf(HasSubstr("synthetic_3: 2 proposals are skipped (77.png, 78.png)"),
                                                  HasSubstr("no view of the scene has their name"))));
}

TEST_F(FolderLayoutTest, SkipsAmbiguousNames) {
  request_.dataset.push_back({"night/1.jpg", RigCamera({5, 1, 1}, {0, 0, 0})});
  request_.test.push_back({"night/3.jpg", RigCamera({5, 2, 1}, {0, 0, 0})});
  for (const char* name : {"1", "night_1", "images_3", "3", "2"})
    Paint(std::string("synthetic_3/") + name + ".png", {1, 2, 3});
  EXPECT_THAT(NamesOf(Read()), ElementsAre("2", "images_3", "night_1"));
  ASSERT_EQ(events_.warnings.size(), 2u);
  EXPECT_THAT(events_.warnings[0], AllOf(HasSubstr("(1.png)"), HasSubstr("several views")));
  EXPECT_THAT(events_.warnings[1], AllOf(HasSubstr("(3.png)"), HasSubstr("the name of a test view")));
}

TEST_F(FolderLayoutTest, SkipsTestViewsByName) {
  Paint("synthetic_3/0.png", {1, 2, 3});
  Paint("synthetic_3/images_8.png", {1, 2, 3});
  Paint("synthetic_3/4.png", {1, 2, 3});
  EXPECT_THAT(NamesOf(Read()), ElementsAre("4"));
  EXPECT_THAT(events_.warnings, ElementsAre(AllOf(HasSubstr("2 proposals are skipped (0.png, images_8.png)"),
                                                  HasSubstr("the name of a test view"))));
  WriteFrames({"0", "1"});
  Paint("0.png", {1, 2, 3});
  Paint("1.png", {1, 2, 3});
  EXPECT_THAT(NamesOf(Read()), ElementsAre("1"));
}

TEST_F(FolderLayoutTest, SkipsUnmatchedFramesAndImages) {
  WriteFrames({"a", "b", "c"});
  EditFrame(2, [](nlohmann::json* frame) { (*frame)["file_path"] = "images/c"; });
  Paint("b.png", {1, 2, 3});
  Paint("images/c.png", {1, 2, 3});
  Paint("images/stray.png", {1, 2, 3});
  EXPECT_THAT(NamesOf(Read()), ElementsAre("b", "images_c"));
  EXPECT_THAT(events_.warnings,
              ElementsAre(AllOf(HasSubstr("1 proposals are skipped (a.png)"), HasSubstr("no image file is there")),
                          AllOf(HasSubstr("(images/stray.png)"), HasSubstr("no frame for them"))));
}

TEST_F(FolderLayoutTest, SkipsDistortedDuplicateAndUnreadable) {
  WriteFrames({"a", "b", "c", "d"});
  for (const char* name : {"a.png", "b.png", "c.png"}) Paint(name, {1, 2, 3});
  WriteText(dir_ / "d.png", "no image");
  EditFrame(1, [](nlohmann::json* frame) { (*frame)["k1"] = 0.1; });
  EditFrame(2, [](nlohmann::json* frame) { (*frame)["file_path"] = "./a.png"; });
  EXPECT_THAT(NamesOf(Read()), ElementsAre("a"));
  EXPECT_EQ(events_.warnings.size(), 4u);
  EXPECT_THAT(events_.warnings, ::testing::IsSupersetOf({AllOf(HasSubstr("(b.png)"), HasSubstr("no pinhole")),
                                                         AllOf(HasSubstr("(./a.png)"), HasSubstr("another image")),
                                                         AllOf(HasSubstr("(d.png)"), HasSubstr("cannot be read"))}));
}

TEST_F(FolderLayoutTest, SkipsImagesElsewhere) {
  WriteFrames({"a", "b"});
  Paint("a.png", {1, 2, 3});
  const TempDir other;
  WritePng(other / "b.png", Image8{1, 1, 3, {1, 2, 3}});
  EditFrame(1, [&](nlohmann::json* frame) { (*frame)["file_path"] = (other / "b.png").string(); });
  EXPECT_THAT(NamesOf(Read()), ElementsAre("a"));
  EXPECT_THAT(events_.warnings, ElementsAre(HasSubstr("lies outside the folder")));
}

TEST_F(FolderLayoutTest, RefusesDamagedTransforms) {
  Paint("a.png", {1, 2, 3});
  WriteFrames({"a"});
  EditFrame(0, [](nlohmann::json* frame) { (*frame)["transform_matrix"][0][0] = 7; });
  EXPECT_THAT(ErrorOf(), HasSubstr("transforms.json: frame 'a.png': \"transform_matrix\""));
  WriteText(dir_ / "transforms.json", "{\"frames\": [");
  EXPECT_THAT(ErrorOf(), HasSubstr("transforms.json: is not valid JSON"));
}

}  // namespace
}  // namespace oraclegs
