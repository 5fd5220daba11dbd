#include "oraclegs/scene/photo_kind.h"

#include "oraclegs/image/codecs.h"
#include "scene/tiny_scenes.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

TEST(IsHelperFolder, KnowsFoldersOfMaps) {
  for (const char* name :
       {"masks",      "mask",       "images_4",     "depth",   "Depth",      "lowres_depth", "renderedDepth",
        "depth_maps", "confidence", "conf",         "normals", "thumbnails", "thumbs",       "sam_masks",
        "@eaDir",     "__MACOSX",   "segmentation", "masks_2", "depth_png",  "depth_vis",    "normal_maps"})
    EXPECT_TRUE(IsHelperFolder(name)) << name;
  for (const char* name :
       {"images", "images_", "images_a", "_masks", "photos", "indepth", "masked ball", "depth_test_photos",
        "depth_scan", "normal images", "color", "normal photos", "conference", "rgb", ""})
    EXPECT_FALSE(IsHelperFolder(name)) << name;
}

TEST(WhyNotRead, KnowsRawPhotosAndVideos) {
  EXPECT_THAT(WhyNotRead("a.NEF"), HasSubstr("raw photos"));
  EXPECT_THAT(WhyNotRead("a.mp4"), HasSubstr("videos"));
  EXPECT_EQ(WhyNotRead("a.jpg"), "");
  EXPECT_EQ(WhyNotRead("a.jfif"), "");
  EXPECT_EQ(WhyNotRead("a.txt"), "");
}

TEST(IsPhotoByContent, LooksAtNamesOfWhatIsNoPhotoAlone) {
  const std::string jpeg = "\xFF\xD8\xFF\xE0", tiff("II*\0", 4);
  for (const char* name : {"a", "a.dat", "a.gif", "a.jfif", "a.jpg", "a.123"})
    EXPECT_TRUE(IsPhotoByContent(name, jpeg)) << name;
  for (const char* name : {"a.thm", "a.THM", "a.insp", "a.jpg_original", "a.jpg~", "a.jpg.bak", "a.part"})
    EXPECT_FALSE(IsPhotoByContent(name, jpeg)) << name;
  EXPECT_TRUE(IsPhotoByContent("a", tiff));
  for (const char* name : {"a.NEF", "a.gpr", "a.IIQ", "a.new-raw"}) EXPECT_FALSE(IsPhotoByContent(name, tiff)) << name;
  for (const char* name : {"a.gpr", "a.IIQ", "a.3fr"}) EXPECT_THAT(WhyNotRead(name), HasSubstr("raw photos")) << name;
  EXPECT_TRUE(IsPhotoByContent("a.NEF", jpeg)) << "exported under the old name";
  for (const std::string& head : {std::string(), std::string("text"), std::string("\xFF\xD8")})
    EXPECT_FALSE(IsPhotoByContent("a.jpg", head));
}

class TakeCompanionsTest : public ::testing::Test {
 protected:
  void Gray(const std::string& name) {
    fs::create_directories((dir_ / name).parent_path());
    WritePng(dir_ / name, {6, 4, 1, std::vector<uint8_t>(24, 9)});
  }
  void Color(const std::string& name) { WriteImage(dir_ / name); }
  /// Names that are taken, of all files.
  std::vector<std::string> Taken() {
    std::vector<fs::path> photos;
    for (const auto& entry : fs::recursive_directory_iterator(dir_.path())) {
      if (entry.is_regular_file() && entry.path().extension() != ".json") photos.push_back(entry.path());
    }
    const size_t all = photos.size();
    std::vector<std::string> names;
    for (const fs::path& path : TakeCompanions(&photos)) names.push_back(path.lexically_relative(dir_.path()).string());
    EXPECT_EQ(photos.size() + names.size(), all);
    return names;
  }
  TempDir dir_;
};

TEST_F(TakeCompanionsTest, KnowsMapsByTheNamesOfPhotos) {
  for (const char* name :
       {"frame_00000.png", "depth_00000.png", "conf_00000.png", "thumb_00000.png", "x.color.png", "x.depth.png",
        "IMG_7.png", "IMG_7_mask.png", "IMG_7.png.mask.png", "IMG_8_depth.png", "thumbnail.png", "mask of clay.png"})
    Color(name);
  EXPECT_THAT(Taken(), UnorderedElementsAre("depth_00000.png", "conf_00000.png", "thumb_00000.png", "x.depth.png",
                                            "IMG_7_mask.png", "IMG_7.png.mask.png", "thumbnail.png"));
}

TEST_F(TakeCompanionsTest, KnowsMapsByTheirPixels) {
  Color("a/1.png");
  Gray("label maps/1.png");
  Gray("a/2.png");
  EXPECT_THAT(Taken(), UnorderedElementsAre("label maps/1.png")) << "a gray photo of another name is one";
}

TEST_F(TakeCompanionsTest, KnowsDepthMapsByTheirBits) {
  Color("1.png");
  WritePng16(dir_ / "2.png", 6, 4, std::vector<uint16_t>(24, 900));
  EXPECT_THAT(Taken(), UnorderedElementsAre("2.png"));
}

TEST_F(TakeCompanionsTest, LeavesGrayPhotosAmongThemselves) {
  for (const char* name : {"left/1.png", "right/1.png"}) Gray(name);
  EXPECT_THAT(Taken(), IsEmpty());
}

TEST_F(TakeCompanionsTest, KnowsSplatTables) {
  for (const char* name : {"means_l.webp", "quats.webp", "sh0.webp", "photo.webp", "apart/sh0.webp"}) Color(name);
  WriteText(dir_ / "meta.json", "{}");
  EXPECT_THAT(Taken(), UnorderedElementsAre("means_l.webp", "quats.webp", "sh0.webp"));
}

}  // namespace
}  // namespace oraclegs
