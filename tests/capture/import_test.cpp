#include "oraclegs/capture/import.h"

#include "capture/video_files.h"
#include "image/jpeg_files.h"
#include "oraclegs/core/files.h"
#include "oraclegs/scene/photo_folder.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

class ImportTest : public ::testing::Test {
 protected:
  fs::path Photo(const std::string& name, int width = 16) {
    WriteText(dir_ / name, EncodeJpeg(SmoothImage(width, 12, 3)));
    return dir_ / name;
  }
  std::vector<std::string> Import(const std::vector<fs::path>& inputs, int frames = 24) {
    CheckInputs(inputs);
    fs::create_directories(dir_ / "out");
    ImportPhotos(inputs, frames, dir_ / "out/photos", events_.AsListener());
    std::vector<std::string> names;
    const fs::path images = dir_ / "out/photos/images";
    for (const auto& entry : fs::recursive_directory_iterator(images)) {
      if (entry.is_regular_file()) names.push_back(entry.path().lexically_relative(images).string());
    }
    return names;
  }

  TempDir dir_;
  EventRecorder events_;
};

TEST_F(ImportTest, TakesFilesAndFolders) {
  const std::vector<fs::path> inputs = {Photo("a/x 'y'.jpg"), Photo("b/x 'y'.jpg"), Photo("c/line\nbreak \xC3\xA4.jpg"),
                                        dir_ / "more"};
  Photo("more/1.jpg");
  Photo("more/deep/2.jpg");
  WriteText(dir_ / "more/raw.NEF", "x");
  EXPECT_THAT(Import(inputs), UnorderedElementsAre("x 'y'.jpg", "x 'y'-2.jpg", "line?break \xC3\xA4.jpg", "more/1.jpg",
                                                   "more/deep/2.jpg"));
  ASSERT_EQ(events_.warnings.size(), 1u);
  EXPECT_THAT(events_.warnings[0], HasSubstr("raw.NEF"));
  EXPECT_FALSE(fs::exists(dir_ / "out/.oraclegs-photos.tmp"));
}

TEST_F(ImportTest, GivesNamesByWhichPhotosAreFoundAgain) {
  EXPECT_THAT(Import({Photo("masks/a.jpg").parent_path(), Photo("images_4/b.jpg").parent_path(), Photo("images/c.jpg"),
                      Photo("depth/d.jpg").parent_path(), Photo("without"), Photo("a.gif"), Photo("b.mp4")}),
              UnorderedElementsAre("_masks/a.jpg", "_images_4/b.jpg", "c.jpg", "_depth/d.jpg", "without.jpg",
                                   "a.gif.jpg", "b.mp4.jpg"));
  EXPECT_EQ(FindPhotos(dir_ / "out/photos", Silent()).size(), 7u);
  EXPECT_THAT(Import({Photo("only/normal/a.jpg").parent_path().parent_path(), Photo("c.jpg")}),
              UnorderedElementsAre("only/_normal/a.jpg", "c.jpg"));
}

TEST_F(ImportTest, NamesPosesThatAloneWouldBeRead) {
  WriteText(Photo("scene/a.jpg").parent_path() / "transforms.json", "{}");
  Import({dir_ / "scene", Photo("b.jpg")});
  EXPECT_THAT(events_.notes, ::testing::Contains(HasSubstr("scene: transforms.json has poses, which are not read")));
}

TEST_F(ImportTest, TakesBackupsThatAreNamed) {
  EXPECT_THAT(Import({Photo("a.jpg.bak"), Photo("b.jpg~"), Photo("c.orig")}),
              UnorderedElementsAre("a.jpg.bak.jpg", "b.jpg~.jpg", "c.orig.jpg"));
}

TEST_F(ImportTest, IsNotRepeatedForTheSameInputs) {
  const std::vector<fs::path> inputs = {Photo("a.jpg"), Photo("b.jpg")};
  Import(inputs);
  const auto time = fs::last_write_time(dir_ / "out/photos");
  Import(inputs);
  EXPECT_EQ(fs::last_write_time(dir_ / "out/photos"), time);
  EXPECT_EQ(events_.started.size(), 1u);
  Photo("b.jpg", 40);  // changed
  Import(inputs);
  EXPECT_EQ(events_.started.size(), 2u);
  EXPECT_EQ(ReadFile(dir_ / "out/photos/images/b.jpg"), ReadFile(dir_ / "b.jpg"));
  Import(inputs, 10);
  EXPECT_EQ(events_.started.size(), 3u);
}

TEST_F(ImportTest, IsRepeatedWhenPhotosAreNotWhole) {
  const std::vector<fs::path> inputs = {Photo("a.jpg"), Photo("b.jpg")};
  const auto faults = {+[](const fs::path& photo) { fs::resize_file(photo, 0); },  // as after a power cut
                       +[](const fs::path& photo) { fs::remove(photo); }};
  Import(inputs);
  for (const auto fault : faults) {
    fault(dir_ / "out/photos/images/b.jpg");
    EXPECT_THAT(Import(inputs), UnorderedElementsAre("a.jpg", "b.jpg"));
    EXPECT_EQ(ReadFile(dir_ / "out/photos/images/b.jpg"), ReadFile(dir_ / "b.jpg"));
  }
  EXPECT_EQ(events_.started.size(), 3u);
}

TEST_F(ImportTest, GivesNamesThatDifferInMoreThanCase) {
  EXPECT_THAT(Import({Photo("a/IMG.JPG"), Photo("b/img.jpg"), Photo("c/1.jpg").parent_path(),
                      Photo("d/C/1.jpg").parent_path()}),
              UnorderedElementsAre("IMG.JPG", "img-2.jpg", "c/1.jpg", "C-2/1.jpg"));
}

TEST_F(ImportTest, TakesPhotosOutOfAVideo) {
  WriteVideo(dir_ / "clip.mp4", 2);
  EXPECT_EQ(Import({dir_ / "clip.mp4"}, 5).size(), 5u);
  EXPECT_THAT(Import({dir_ / "clip.mp4", Photo("a.jpg")}, 3),
              UnorderedElementsAre("a.jpg", "clip/frame_0001.jpg", "clip/frame_0002.jpg", "clip/frame_0003.jpg"));
}

TEST_F(ImportTest, NamesWhatCannotBeTaken) {
  const auto error = [&](const fs::path& input) { return MessageOf<InputError>([&] { CheckInputs({input}); }); };
  WriteText(dir_ / "notes.txt", "text");
  WriteText(dir_ / "raw.CR2", "x");
  WriteText(dir_ / "a.jpg", "no JPEG");
  fs::create_directories(dir_ / "empty");
  EXPECT_THAT(error(dir_ / "missing.jpg"), HasSubstr("missing.jpg: no such file or folder"));
  EXPECT_THAT(error(dir_ / "notes.txt"), HasSubstr("notes.txt: is neither a photo, a video"));
  EXPECT_THAT(error(dir_ / "raw.CR2"), HasSubstr("raw.CR2: raw photos are not read"));
  EXPECT_THAT(error(dir_ / "a.jpg"), HasSubstr("a.jpg: "));
  EXPECT_THAT(error(dir_ / "empty"), HasSubstr("empty: holds no photos"));
  EXPECT_TRUE(IsUsedInPlace({dir_ / "empty"}));
  EXPECT_FALSE(IsUsedInPlace({dir_ / "a.jpg"}));
  EXPECT_FALSE(IsUsedInPlace({dir_ / "empty", dir_ / "empty"}));
}

TEST_F(ImportTest, LeavesNothingHalf) {
  const fs::path photo = Photo("a.jpg");
  fs::create_directories(dir_ / "out");
  WriteText(dir_ / "out/.oraclegs-photos.tmp/stale.jpg", "of a run that was killed");
  EXPECT_THAT(Import({photo, Photo("b.jpg")}), UnorderedElementsAre("a.jpg", "b.jpg"));
}

}  // namespace
}  // namespace oraclegs
