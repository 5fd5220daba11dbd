#include "oraclegs/capture/photo_checks.h"

#include "image/jpeg_files.h"
#include "image/photo_files.h"
#include "oraclegs/image/codecs.h"
#include "support/event_recorder.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Blocks of random colors: sharp edges everywhere.
Image8 Blocks(int width, int height, uint32_t seed) {
  Image8 image{width, height, 3, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const uint32_t h =
          (static_cast<uint32_t>(x / 20) * 73856093u ^ static_cast<uint32_t>(y / 20) * 19349663u ^ seed) * 2654435761u;
      for (int c = 0; c < 3; ++c) image.data.push_back(static_cast<uint8_t>(40 + (h >> 24) * 170 / 255));
    }
  }
  return image;
}

class PhotoChecksTest : public ::testing::Test {
 protected:
  void Add(const std::string& name, const Image8& image) {
    WriteText(dir_ / name, EncodeJpeg(image));
    photos_.push_back({name, dir_ / name});
  }
  std::vector<std::string> Check() { return CheckPhotos(photos_, events_.AsListener()).warnings; }

  TempDir dir_;
  std::vector<CheckedPhoto> photos_;
  EventRecorder events_;
};

TEST_F(PhotoChecksTest, IsSilentAboutGoodPhotos) {
  for (uint32_t i = 0; i < 5; ++i) Add(fmt::format("{}.jpg", i), Blocks(320, 240, i * 1000003u));
  EXPECT_THAT(Check(), IsEmpty());
  EXPECT_EQ(events_.steps.size(), 5u);
}

TEST_F(PhotoChecksTest, NamesEachTrouble) {
  for (uint32_t i = 0; i < 6; ++i) Add(fmt::format("{}.jpg", i), Blocks(320, 240, i * 1000003u));
  const Image8 sharp = Blocks(320, 240, 77);
  Add("blurred.jpg", ToImage8(ResizeArea(ResizeArea(ToFloat(sharp), 20, 15), 320, 240)));
  Add("black.jpg", {320, 240, 3, std::vector<uint8_t>(320 * 240 * 3, 3)});
  Add("white.jpg", {320, 240, 3, std::vector<uint8_t>(320 * 240 * 3, 254)});
  Add("again.jpg", Blocks(320, 240, 0));
  Add("wide.jpg", Blocks(640, 240, 5));
  WritePng(dir_ / "screen.png", {1170, 2532, 3, std::vector<uint8_t>(1170 * 2532 * 3, 240)});
  photos_.push_back({"screen.png", dir_ / "screen.png"});
  EXPECT_THAT(Check(),
              ElementsAre(HasSubstr("blurred.jpg: is blurred"), HasSubstr("black.jpg: is almost black"),
                          HasSubstr("white.jpg: is mostly white"), HasSubstr("0.jpg and again.jpg: show the same"),
                          HasSubstr("wide.jpg: is a panorama"), HasSubstr("screen.png: looks like a screenshot")));
}

/// Blocks in the middle of an image that is `level` elsewhere.
Image8 Before(uint8_t level, uint32_t seed) {
  Image8 image{320, 240, 3, std::vector<uint8_t>(320 * 240 * 3, level)};
  const Image8 object = Blocks(120, 100, seed);
  for (size_t y = 0; y < 100; ++y)
    std::copy_n(object.data.begin() + 360 * static_cast<int>(y), 360,
                image.data.begin() + 3 * (320 * (70 + static_cast<int>(y)) + 100));
  return image;
}

TEST_F(PhotoChecksTest, ABackdropIsNeitherTooBrightNorTooDark) {
  for (uint32_t i = 0; i < 4; ++i) Add(fmt::format("{}.jpg", i), Before(255, i * 1000003u));
  EXPECT_THAT(Check(), IsEmpty());
  photos_.clear();
  for (uint32_t i = 0; i < 4; ++i) Add(fmt::format("{}.jpg", i), Before(0, i * 1000003u));
  EXPECT_THAT(Check(), IsEmpty());
  Add("room.jpg", Blocks(320, 240, 5));
  EXPECT_THAT(Check(), ElementsAre(HasSubstr("0.jpg, 1.jpg, 2.jpg, 3.jpg: are almost black")));
}

TEST_F(PhotoChecksTest, FindsWhatStandsBeforeWhite) {
  const auto on_white = [&](const std::vector<std::string>& names) {
    std::vector<std::filesystem::path> paths;
    for (const std::string& name : names) paths.push_back(dir_ / name);
    return AreOnWhite(paths);
  };
  for (uint32_t i = 0; i < 3; ++i) Add(fmt::format("{}.jpg", i), Before(255, i * 1000003u));
  Add("black.jpg", Before(0, 7)), Add("gray.jpg", Before(240, 7));
  Add("white.jpg", {320, 240, 3, std::vector<uint8_t>(320 * 240 * 3, 255)});
  EXPECT_TRUE(on_white({"0.jpg", "1.jpg", "2.jpg"}));
  EXPECT_TRUE(on_white({"0.jpg"}));
  EXPECT_FALSE(on_white({"0.jpg", "1.jpg", "black.jpg"})) << "the last one";
  EXPECT_FALSE(on_white({"0.jpg", "gray.jpg", "2.jpg"})) << "the middle one";
  EXPECT_FALSE(on_white({"white.jpg", "0.jpg", "1.jpg"})) << "the first one shows nothing";
  EXPECT_FALSE(on_white({"0.jpg", "1.jpg", "missing.jpg"}));
  EXPECT_FALSE(on_white({}));
  Image8 transparent{8, 8, 4, std::vector<uint8_t>(8 * 8 * 4, 255)};
  transparent.data[4 * 27] = 0;
  WritePng(dir_ / "transparent.png", transparent);
  EXPECT_FALSE(on_white({"transparent.png"}));
}

TEST_F(PhotoChecksTest, KnowsSphericalImagesByTheirMetadata) {
  const std::string jpeg = EncodeJpeg(Blocks(320, 240, 1));
  const std::string xmp = "http://ns.adobe.com/xap/1.0/ GPano:ProjectionType=\"equirectangular\"";
  const size_t length = xmp.size() + 2;
  WriteText(dir_ / "a.jpg", jpeg.substr(0, 2) + "\xFF\xE1" + static_cast<char>(length >> 8) +
                                static_cast<char>(length & 255) + xmp + jpeg.substr(2));
  EXPECT_TRUE(ReadSigns(dir_ / "a.jpg").is_panorama);
  photos_.push_back({"a.jpg", dir_ / "a.jpg"});
  Add("flat.jpg", Blocks(480, 240, 1000003u));
  Add("photo.jpg", Blocks(320, 240, 2000006u));
  EXPECT_THAT(Check(), ElementsAre(HasSubstr("a.jpg: is a panorama but no whole sphere"),
                                   HasSubstr("flat.jpg: may be a spherical photo")));
  for (CheckedPhoto& photo : photos_) photo.is_sphere = true;
  EXPECT_THAT(Check(), IsEmpty()) << "they are used as spheres";
}

/// Blocks in image circles side by side.
Image8 Circles(int count, uint32_t seed) {
  Image8 image = Blocks(240 * count, 240, seed);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 240 * count; ++x) {
      uint8_t* pixel = image.data.data() + 3 * (y * 240 * count + x);
      const bool lit = std::hypot(x % 240 - 119.5, y - 119.5) < 118;
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<uint8_t>(lit ? std::max<int>(pixel[c], 40) : 3);
    }
  }
  return image;
}

TEST_F(PhotoChecksTest, KnowsImageCirclesOfFisheyeLenses) {
  Add("one.jpg", Circles(1, 1));
  Add("two.jpg", Circles(2, 1000003u));
  Add("wide.jpg", Blocks(480, 240, 2000006u));
  Add("photo.jpg", Blocks(240, 240, 3000009u));
  EXPECT_THAT(Check(), ElementsAre(HasSubstr("wide.jpg: may be a spherical photo"),
                                   AllOf(HasSubstr("one.jpg: is the image circle"), HasSubstr("OPENCV_FISHEYE")),
                                   AllOf(HasSubstr("two.jpg: is two image circles"), HasSubstr("stitch them"))));
  EXPECT_EQ(ReadSigns(dir_ / "two.jpg").circles, 2);
  for (uint32_t i = 0; i < 2; ++i) Add(fmt::format("{}.jpg", i), Circles(2, 7 + i * 1000003u));
  EXPECT_THAT(Check(), ::testing::Contains(HasSubstr(": are two image circles of fisheye lenses each")));
}

TEST_F(PhotoChecksTest, LeavesOutWhatCannotBeDecoded) {
  for (uint32_t i = 0; i < 4; ++i) Add(fmt::format("{}.jpg", i), Blocks(320, 240, i * 1000003u));
  std::filesystem::resize_file(dir_ / "1.jpg", std::filesystem::file_size(dir_ / "1.jpg") / 2);
  const PhotoTrouble trouble = CheckPhotos(photos_, events_.AsListener());
  EXPECT_THAT(trouble.unreadable, ElementsAre(1));
  EXPECT_THAT(trouble.warnings, ElementsAre(AllOf(HasSubstr("1.jpg"), HasSubstr("it is left out"))));
  photos_.pop_back();
  EXPECT_THROW(Check(), InputError) << "two good ones are too few";
}

TEST_F(PhotoChecksTest, TakesFilmFramesForPhotos) {
  for (uint32_t i = 0; i < 3; ++i) Add(fmt::format("{}.jpg", i), Blocks(560, 240, i * 1000003u));
  EXPECT_THAT(Check(), IsEmpty());
}

TEST(Sharpness, FallsWithBlur) {
  Image8 noise{64, 48, 1, {}};
  uint32_t state = 1;
  for (int i = 0; i < 64 * 48; ++i)
    noise.data.push_back(static_cast<uint8_t>((state = state * 1664525u + 1013904223u) >> 24));
  const Image8 blurred = ToImage8(ResizeArea(ResizeArea(ToFloat(noise), 16, 12), 64, 48));
  EXPECT_GT(Sharpness(noise), 10 * Sharpness(blurred));
  EXPECT_EQ(Sharpness({64, 48, 1, std::vector<uint8_t>(64 * 48, 7)}), 0);
  EXPECT_EQ(Sharpness({2, 2, 1, {1, 2, 3, 4}}), 0);
}

}  // namespace

}  // namespace oraclegs
