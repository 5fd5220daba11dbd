#include "oraclegs/scene/named_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class NamedFilesTest : public ::testing::Test {
 protected:
  void Make(const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      fs::create_directories((root() / name).parent_path());
      WriteText(root() / name, "x");
    }
  }
  /// The files below the scene's folder that the paths mean, "" for none.
  std::vector<std::string> Find(const std::vector<std::string>& written, size_t min_parts = 1) {
    std::vector<std::string> found;
    for (const NamedFile& file : FindNamedFiles({"FILE", root(), written, min_parts}, events_.AsListener())) {
      found.push_back(file.path.empty() ? "" : file.path.lexically_relative(root()).generic_string());
    }
    return found;
  }
  fs::path root() const { return dir_ / "scene"; }

  TempDir dir_;
  EventRecorder events_;
};

TEST_F(NamedFilesTest, TakesPathsAsWrittenWithoutAWord) {
  Make({"images/a.png", "b\\c.png"});
  EXPECT_THAT(Find({"images/a.png", "b\\c.png", "./images/../images/a.png"}),
              ElementsAre("images/a.png", "b\\c.png", "./images/../images/a.png"));
  EXPECT_THAT(events_.notes, IsEmpty());
}

TEST_F(NamedFilesTest, ReadsPathsOfOtherSystems) {
  Make({"images/a.png", "images/b.png"});
  EXPECT_THAT(Find({"images\\a.png", ".\\images\\b.png"}), ElementsAre("images/a.png", "images/b.png"));
  EXPECT_THAT(events_.notes, ElementsAre(AllOf(HasSubstr("FILE: 2 of 2 paths name no file as written"),
                                               HasSubstr("with / for \\: images/a.png for 'images\\a.png'"))));
}

TEST_F(NamedFilesTest, TakesTheLongestEndOfAPath) {
  Make({"left/a.png", "right/a.png", "b.png"});
  EXPECT_THAT(Find({"/home/me/scan/left/a.png", "C:\\scan\\right\\a.png", "\\\\server\\scan\\b.png"}),
              ElementsAre("left/a.png", "right/a.png", "b.png"));
  EXPECT_THAT(events_.notes, ElementsAre(HasSubstr("by the ends of their paths")));
  EXPECT_THAT(Find({"/home/me/scan/top/a.png"}), ElementsAre(""));  // of two folders
}

TEST_F(NamedFilesTest, TakesNamesAloneWhereTheyAreUnique) {
  Make({"photos/a.png", "photos/b.png"});
  EXPECT_THAT(Find({"a.png", "input/b.png"}), ElementsAre("photos/a.png", "photos/b.png"));
}

TEST_F(NamedFilesTest, LeavesNoFolderOutWhereOtherPathsStand) {
  Make({"images/a.png", "old/b.png", "images/sub/c.png"});
  EXPECT_THAT(Find({"images/a.png", "images/b.png", "images/c.png"}), ElementsAre("images/a.png", "", ""));
  EXPECT_THAT(events_.notes, IsEmpty());
}

TEST_F(NamedFilesTest, FoldsCaseUnicodeFormAndExtension) {
  Make({"images/IMG_1.JPG", "images/Ku\u0308che.png", "images/c.heic", "images/d.jpg", "images/D.JPG"});
  EXPECT_THAT(Find({"Images/img_1.jpg", "images/K\u00FCche.png", "images/c.png", "images/d.Jpg"}),
              ElementsAre("images/IMG_1.JPG", "images/Ku\u0308che.png", "images/c.heic", ""));
  EXPECT_THAT(events_.notes, ElementsAre(HasSubstr("in another case or Unicode form, with another extension")));
}

TEST_F(NamedFilesTest, TakesNoMaskForAPhoto) {
  Make({"masks/a.png", "depth/a.png", "images_4/a.png", "object_masks/a.png", ".hidden/a.png", "a.txt"});
  EXPECT_THAT(Find({"images/a.png"}), ElementsAre(""));
  EXPECT_THAT(Find({"C:\\x\\depth\\a.png"}), ElementsAre("depth/a.png"));
}

TEST_F(NamedFilesTest, SurvivesPathsThatAreNone) {
  Make({"images/a.png"});
  EXPECT_THAT(Find({"", "/", "\\", "C:\\", "..", std::string(100000, '/') + "x", "images/a.png"}),
              ElementsAre("", "", "", "", "", "", "images/a.png"));
}

TEST_F(NamedFilesTest, AsksForMorePartsThanTheName) {
  Make({"images/a.png"});
  EXPECT_THAT(Find({"C:\\x\\masks\\a.png"}, 2), ElementsAre(""));
}

TEST_F(NamedFilesTest, GivesNoFileToTwoPaths) {
  Make({"images/a.png"});
  EXPECT_THAT(Find({"/x/left/a.png", "/x/right/a.png"}), ElementsAre("", ""));
  EXPECT_THAT(events_.notes, IsEmpty());
}

TEST_F(NamedFilesTest, LetsPathsThatAreEqualShareAFileWhereTheyMay) {
  Make({"masks/static.png", "masks/a.png"});
  const std::string all = "C:\\x\\masks\\static.png";
  const auto files = FindNamedFiles(
      {"FILE", root(), {all, all, "C:\\x\\left\\masks\\a.png", "C:\\x\\masks\\a.png"}, 2, false, true}, Silent());
  EXPECT_EQ(files[0].path, root() / "masks/static.png");
  EXPECT_EQ(files[1].path, root() / "masks/static.png");
  EXPECT_TRUE(files[2].path.empty() && files[3].path.empty()) << "of two names";
}

TEST_F(NamedFilesTest, PrefersTheSceneToThePlaceItWasMovedFrom) {
  Make({"../before/images/a.png", "../before/images/b.png", "images/a.png"});
  const std::string before = (dir_ / "before/images").string();
  EXPECT_THAT(Find({before + "/a.png"}), ElementsAre("images/a.png"));
  EXPECT_THAT(Find({before + "/b.png"}), ElementsAre("../before/images/b.png"));  // who reads the scene refuses it
}

TEST_F(NamedFilesTest, FollowsALinkToAFolderOnce) {
  Make({"../elsewhere/a.png"});
  fs::create_directories(root());
  fs::create_directory_symlink(dir_ / "elsewhere", root() / "photos");
  fs::create_directory_symlink(root(), dir_ / "elsewhere/back");
  EXPECT_THAT(Find({"/x/a.png"}), ElementsAre("photos/a.png"));
}

TEST_F(NamedFilesTest, PrefersFoldersToLinks) {
  Make({"images/a.png"});
  fs::create_directory_symlink("images", root() / "also");
  fs::create_directory_symlink(".", root() / "again");
  EXPECT_THAT(Find({"/x/a.png"}), ElementsAre("images/a.png"));
}

TEST(LiesIn, ComparesWholeNames) {
  EXPECT_TRUE(LiesIn("/a/b", "/a/b/../b/c"));
  EXPECT_FALSE(LiesIn("/a/b", "/a/bc"));
  EXPECT_FALSE(LiesIn("/a/b", "/a/b/../c"));
}

}  // namespace
}  // namespace oraclegs
