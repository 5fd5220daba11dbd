#include "oraclegs/image/image.h"

#include <cmath>
#include <limits>

#include "scene/jpeg_files.h"

namespace oraclegs {
namespace {

using ::testing::HasSubstr;

TEST(Image, TheFormatIsKnownByContentNotByName) {
  const TempDir dir;
  WriteText(dir / "really_jpeg.png", EncodeJpeg(SmoothPicture(20, 12, 3)));
  WritePng(dir / "really_png.jpg", SmoothPicture(9, 7, 4));
  EXPECT_EQ(ReadImage(dir / "really_jpeg.png").width, 20);
  EXPECT_EQ(ReadImage(dir / "really_png.jpg").channels, 4);
}

TEST(Image, TheSizeFromTheHeaderIsThatOfTheUprightPicture) {
  const TempDir dir;
  WriteText(dir / "a.jpg", WithOrientation(EncodeJpeg(SmoothPicture(20, 12, 3)), 8));
  WritePng(dir / "b.png", SmoothPicture(9, 7, 4));
  for (const char* name : {"a.jpg", "b.png"}) {
    int width = 0, height = 0;
    ReadImageSize(dir / name, &width, &height);
    const Image8 image = ReadImage(dir / name);
    EXPECT_EQ(width, image.width) << name;
    EXPECT_EQ(height, image.height) << name;
  }
  EXPECT_EQ(ReadImage(dir / "a.jpg").width, 12);
  EXPECT_EQ(ReadImage(dir / "a.jpg", Orientation::kAsStored).width, 20);
}

TEST(Image, WhatIsNotAPictureIsAnErrorThatNamesTheFile) {
  const TempDir dir;
  WriteText(dir / "empty.png", "");
  WriteText(dir / "text.png", "Dear diary");
  WriteText(dir / "start.jpg", "\xFF\xD8\xFF");
  WriteText(dir / "start.png", "\x89PNG\r\n\x1a\n");
  std::filesystem::create_directories(dir / "folder.png");
  for (const char* name : {"empty.png", "text.png", "start.jpg", "start.png", "folder.png", "missing.png"}) {
    int width = 0, height = 0;
    EXPECT_THAT(InputErrorOf([&] { ReadImage(dir / name); }), HasSubstr(name));
    EXPECT_THAT(InputErrorOf([&] { ReadImageSize(dir / name, &width, &height); }), HasSubstr(name));
  }
  EXPECT_THAT(InputErrorOf([&] { ReadImage(dir / "text.png"); }), HasSubstr("not a JPEG or PNG"));
  EXPECT_THAT(InputErrorOf([&] { ReadImage(dir / "empty.png"); }), HasSubstr("is empty"));
}

TEST(Image, ExtensionsInAnyCase) {
  for (const char* name : {"a.jpg", "a.JPG", "b/a.Jpeg", "a.png", "a.b.PNG"})
    EXPECT_TRUE(HasImageExtension(name)) << name;
  for (const char* name : {"a.jp", "a", "a.png.txt", "png", ".png", "a.webp"})
    EXPECT_FALSE(HasImageExtension(name)) << name;
}

TEST(Image, EightBitsSurviveTheWayThroughFloat) {
  Image8 all{16, 16, 1, {}};
  for (int i = 0; i < 256; ++i) all.data.push_back(static_cast<uint8_t>(i));
  const ImageF floats = ToFloat(all);
  EXPECT_EQ(floats.data.front(), 0.f);
  EXPECT_EQ(floats.data.back(), 1.f);
  EXPECT_EQ(ToImage8(floats).data, all.data);
}

TEST(Image, ToImage8ClampsAndRoundsHalfUp) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const ImageF image{6, 1, 1, {-1.f, 2.f, nan, 0.4999f / 255, 0.5f / 255, 254.5f / 255}};
  EXPECT_THAT(ToImage8(image).data, testing::ElementsAre(0, 255, 0, 0, 1, 255));
}

}  // namespace
}  // namespace oraclegs
