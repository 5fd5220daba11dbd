#include "oraclegs/image/read_image.h"

#include "image/jpeg_files.h"
#include "image/photo_files.h"
#include "oraclegs/image/png.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using ::testing::HasSubstr;

TEST(ReadImage, DetectsTheFormatByContent) {
  const TempDir dir;
  WriteText(dir / "really_jpeg.png", EncodeJpeg(SmoothImage(20, 12, 3)));
  WritePng(dir / "really_png.jpg", SmoothImage(9, 7, 4));
  EXPECT_EQ(ReadImage(dir / "really_jpeg.png").width, 20);
  EXPECT_EQ(ReadImage(dir / "really_png.jpg").channels, 4);
}

TEST(ReadImageSize, GivesTheUprightSize) {
  const TempDir dir;
  WriteText(dir / "a.jpg", WithOrientation(EncodeJpeg(SmoothImage(20, 12, 3)), 8));
  WritePng(dir / "b.png", SmoothImage(9, 7, 4));
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

TEST(ReadImage, ReadsWhatPhonesAndScannersWrite) {
  const TempDir dir;
  const Image8 image = SmoothImage(32, 24, 3);
  WriteText(dir / "a.jpg", EncodeHeif(image, PhoneExif(6)));
  WriteText(dir / "b.jpg", EncodeWebp(image));
  EncodeTiff(dir / "c.jpg", image);
  for (const char* name : {"a.jpg", "b.jpg", "c.jpg"}) {
    EXPECT_EQ(ReadImage(dir / name).width, 32) << name;
    int width = 0, height = 0;
    ReadImageSize(dir / name, &width, &height);
    EXPECT_EQ(width, 32) << name;
    EXPECT_EQ(height, 24) << name;
  }
}

TEST(ReadImage, NamesAFileThatIsNoImage) {
  const TempDir dir;
  WriteText(dir / "empty.png", "");
  WriteText(dir / "text.png", "Dear diary");
  WriteText(dir / "start.jpg", "\xFF\xD8\xFF");
  WriteText(dir / "start.png", "\x89PNG\r\n\x1a\n");
  std::filesystem::create_directories(dir / "folder.png");
  for (const char* name : {"empty.png", "text.png", "start.jpg", "start.png", "folder.png", "missing.png"}) {
    int width = 0, height = 0;
    EXPECT_THAT(MessageOf<InputError>([&] { ReadImage(dir / name); }), HasSubstr(name));
    EXPECT_THAT(MessageOf<InputError>([&] { ReadImageSize(dir / name, &width, &height); }), HasSubstr(name));
  }
  EXPECT_THAT(MessageOf<InputError>([&] { ReadImage(dir / "text.png"); }), HasSubstr("is not a JPEG, PNG, HEIC"));
  EXPECT_THAT(MessageOf<InputError>([&] { ReadImage(dir / "empty.png"); }), HasSubstr("is empty"));
}

TEST(HasImageExtension, IgnoresCase) {
  for (const char* name : {"a.jpg", "a.JPG", "b/a.Jpeg", "a.png", "a.b.PNG", "a.HEIC", "a.heif", "a.avif", "a.webp",
                           "a.tif", "a.TIFF", "a.jfif", "a.jpe", "a.MPO"})
    EXPECT_TRUE(HasImageExtension(name)) << name;
  for (const char* name : {"a.jp", "a", "a.png.txt", "png", ".png", "a.gif", "a.cr2"})
    EXPECT_FALSE(HasImageExtension(name)) << name;
}

}  // namespace
}  // namespace oraclegs
