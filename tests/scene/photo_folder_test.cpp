#include "oraclegs/scene/photo_folder.h"

#include "image/jpeg_files.h"
#include "image/photo_files.h"
#include "scene/tiny_scenes.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class PhotoFolderTest : public ::testing::Test {
 protected:
  std::vector<std::string> Names() {
    std::vector<std::string> names;
    for (const SceneView& view : ReadPhotos(dir_.path(), events_.AsListener())) names.push_back(view.name);
    return names;
  }

  TempDir dir_;
  EventRecorder events_;
};

TEST_F(PhotoFolderTest, FindsPhotosInAllFolders) {
  for (const char* name : {"b/1.png", "a/2/x y.png", "a/10.png", "c.png", "umlaut \xC3\xA4 'quoted'.png"})
    WriteImage(dir_ / name);
  for (const char* name : {".hidden/d.png", "._c.png", "masks/c.png", "images_4/c.png"}) WriteImage(dir_ / name);
  WriteImage(dir_ / "out/renders/c.png");
  const std::string inputs(20000, ' ');  // a run may name many
  WriteText(dir_ / "out/options.json", "{\n  \"format\": 1," + inputs + "\n  \"program\": \"oraclegs\"\n}");
  WriteText(dir_ / "notes.txt", "no photo");
  EXPECT_THAT(Names(), ElementsAre("a/2/x y.png", "a/10.png", "b/1.png", "c.png", "umlaut \xC3\xA4 'quoted'.png"));
  EXPECT_THAT(events_.warnings, IsEmpty());
}

TEST_F(PhotoFolderTest, NamesWhatIsSkippedOnceForEachReason) {
  WriteImage(dir_ / "c.png");
  for (const char* name : {"IMG_2.CR2", "IMG_10.CR2", "clip.MOV", "anim.gif", "a\nb.bmp"}) WriteText(dir_ / name, "x");
  Names();
  EXPECT_THAT(events_.warnings,
              ::testing::UnorderedElementsAre("IMG_2.CR2, IMG_10.CR2: raw photos are not read; export them as JPEG",
                                              HasSubstr("clip.MOV: videos beside photos are not read"),
                                              HasSubstr("a?b.bmp, anim.gif: this kind of image is not read")));
}

TEST_F(PhotoFolderTest, LeavesOutDamageWhenEnoughIsLeft) {
  for (const char* name : {"a.png", "b.png"}) WriteImage(dir_ / name);
  WriteText(dir_ / "c.jpg", "no JPEG");
  EXPECT_THAT(MessageOf<InputError>([&] { Names(); }), HasSubstr("c.jpg"));
  WriteImage(dir_ / "d.png");
  EXPECT_THAT(Names(), ElementsAre("a.png", "b.png", "d.png"));
  ASSERT_EQ(events_.warnings.size(), 1u);
  EXPECT_THAT(events_.warnings[0], HasSubstr("c.jpg"));
  EXPECT_THAT(events_.warnings[0], HasSubstr("it is left out"));
}

TEST_F(PhotoFolderTest, KnowsTheCameraFromExif) {
  WriteText(dir_ / "a.jpg", WithExif(EncodeJpeg(SmoothImage(40, 30, 3)), PhoneExif(6)));
  WriteImage(dir_ / "b.png");
  const auto views = ReadPhotos(dir_.path(), Silent());
  ASSERT_EQ(views.size(), 2u);
  EXPECT_EQ(views[0].camera, "Maker Phone 9");
  EXPECT_EQ(views[0].intrinsics.width, 30) << "upright";
  EXPECT_NEAR(views[0].focal_prior, 26 / 43.2666 * 50, 1e-6);
  EXPECT_EQ(views[1].camera, "");
  EXPECT_EQ(views[1].focal_prior, 0);
  ASSERT_TRUE(views[0].gps);
  EXPECT_NEAR(views[0].gps->latitude, 47.51, 1e-9);
  EXPECT_FALSE(views[1].gps);
}

TEST_F(PhotoFolderTest, RefusesTooMany) {
  for (int i = 0; i <= kMaxPhotos; ++i) WriteText(dir_ / fmt::format("{}.jpg", i), "x");
  EXPECT_THAT(MessageOf<InputError>([&] { Names(); }), HasSubstr("has 501 photos, and at most 500"));
}

TEST(FindPhotos, IsEmptyWithoutAFolder) { EXPECT_THAT(FindPhotos("/nonexistent", Silent()), IsEmpty()); }

TEST_F(PhotoFolderTest, KnowsPhotosByContent) {
  for (const char* name : {"a.jfif", "b.jpe", "c.mpo", "d", "e.gif", "f.dat", "g.jpg"})
    WriteText(dir_ / name, EncodeJpeg(SmoothImage(16, 12, 3)));
  for (const char* name : {".DS_Store", "Thumbs.db", "h", "i.txt"}) WriteText(dir_ / name, "no image");
  EXPECT_THAT(Names(), ElementsAre("a.jfif", "b.jpe", "c.mpo", "d", "e.gif", "f.dat", "g.jpg"));
  EXPECT_THAT(events_.warnings, IsEmpty());
  EXPECT_THAT(events_.notes, ElementsAre("d, e.gif, f.dat: read as photos, whatever the names say"));
}

TEST_F(PhotoFolderTest, FollowsLinksToFoldersOnce) {
  const TempDir elsewhere;
  WriteImage(elsewhere / "more/x.png");
  WriteImage(dir_ / "here/a.png");
  std::filesystem::create_directory_symlink(std::filesystem::absolute(elsewhere.path()), dir_ / "linked");
  std::filesystem::create_directory_symlink(std::filesystem::absolute(elsewhere / "more"), dir_ / "linked-again");
  std::filesystem::create_directory_symlink("here", dir_ / "a-link");
  std::filesystem::create_directory_symlink("..", dir_ / "here/up");
  std::filesystem::create_directory_symlink("../..", dir_ / "here/further-up");
  std::filesystem::create_directory_symlink("missing", dir_ / "broken");
  std::filesystem::create_directory_symlink(std::filesystem::absolute(elsewhere.path()), elsewhere / "more/circle");
  EXPECT_THAT(Names(), ElementsAre("here/a.png", "linked/more/x.png"));
}

TEST_F(PhotoFolderTest, PassesOverMapsAndSaysSo) {
  for (const char* name :
       {"a/1.png", "a/1_mask.png", "depth/1.png", "b/Confidence/1.png", "masks/1.png", "thumbs/note.txt"})
    WriteImage(dir_ / name);
  EXPECT_THAT(Names(), ElementsAre("a/1.png"));
  EXPECT_THAT(events_.warnings, IsEmpty());
  EXPECT_THAT(events_.notes,
              ElementsAre(HasSubstr("b/Confidence/, depth/: passed over"), HasSubstr("a/1_mask.png: passed over")));
}

TEST_F(PhotoFolderTest, TakesTheOnlyFolderWhateverItIsCalled) {
  for (const char* name : {"a/normal/1.png", "a/normal/b/2.png", "a/normal/depth/1.png"}) WriteImage(dir_ / name);
  EXPECT_THAT(Names(), ElementsAre("a/normal/1.png", "a/normal/b/2.png"));
  EXPECT_THAT(events_.notes, testing::Contains(HasSubstr("a/normal/: its images are taken for the photos")));
  WriteText(dir_ / "a/1.NEF", "x");
  EXPECT_THAT(Names(), IsEmpty()) << "of photos that are not read";
  std::filesystem::remove(dir_ / "a/1.NEF");
  WriteImage(dir_ / "labels/1.png");
  EXPECT_THAT(Names(), IsEmpty()) << "of two";
}

TEST_F(PhotoFolderTest, TakesNoMasksForPhotos) {
  WriteImage(dir_ / "mask/1.png");
  EXPECT_THAT(Names(), IsEmpty());
  EXPECT_THAT(events_.notes, ElementsAre(HasSubstr("mask/: passed over")));
  WriteImage(dir_ / "1.png");
  events_ = {};
  EXPECT_THAT(Names(), ElementsAre("1.png"));
  EXPECT_THAT(events_.notes, IsEmpty());
}

TEST_F(PhotoFolderTest, PassesOverTexturesOfAMesh) {
  for (const char* name : {"1.png", "model/atlas 1.png", "model/atlas.png"}) WriteImage(dir_ / name);
  WriteText(dir_ / "model/a.mtl", "newmtl a\r\n  Kd 1 1 1\n  map_Kd -s 1 1 atlas.png\r\n");
  EXPECT_THAT(Names(), ElementsAre("1.png", "model/atlas 1.png"));
  EXPECT_THAT(events_.notes, ElementsAre(HasSubstr("model/atlas.png: passed over, as masks, depth maps, textures")));
}

TEST_F(PhotoFolderTest, NamesPosesBesideThePhotosWhereverTheyAre) {
  WriteImage(dir_ / "deep/photos/a.png");
  WriteText(dir_ / "deep/photos/a.xmp", "xmlns:xcr=\"http://www.capturingreality.com/ns/xcr/1.1#\"");
  EXPECT_THAT(Names(), ElementsAre("deep/photos/a.png"));
  EXPECT_THAT(events_.notes, ElementsAre(HasSubstr("deep/photos: a.xmp has poses of RealityScan, which are not read")));
}

TEST_F(PhotoFolderTest, TakesThePhotosOfAKnownLayoutAlone) {
  for (const char* name : {"scan/thumbnail.png", "scan/keyframes/images/1.png", "scan/keyframes/corrected_images/1.png",
                           "scan/keyframes/depth/1.png", "scan/keyframes/confidence/1.png"})
    WriteImage(dir_ / name);
  WriteText(dir_ / "scan/keyframes/corrected_cameras/1.json", "{}");
  EXPECT_THAT(Names(), ElementsAre("scan/keyframes/corrected_images/1.png"));
  EXPECT_THAT(events_.warnings, IsEmpty());
  ASSERT_EQ(events_.notes.size(), 1u);
  EXPECT_THAT(events_.notes[0],
              testing::AllOf(HasSubstr("scan: is a folder of Polycam; its photos are those of keyframes"),
                             HasSubstr("corrected_cameras has poses of Polycam, which are not read")));
}

}  // namespace
}  // namespace oraclegs
