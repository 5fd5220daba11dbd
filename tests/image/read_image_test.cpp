#include "oraclegs/image/read_image.h"

#include "image/jpeg_files.h"
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
  EXPECT_THAT(MessageOf<InputError>([&] { ReadImage(dir / "text.png"); }), HasSubstr("not a JPEG or PNG"));
  EXPECT_THAT(MessageOf<InputError>([&] { ReadImage(dir / "empty.png"); }), HasSubstr("is empty"));
}

TEST(HasImageExtension, IgnoresCase) {
  for (const char* name : {"a.jpg", "a.JPG", "b/a.Jpeg", "a.png", "a.b.PNG"})
    EXPECT_TRUE(HasImageExtension(name)) << name;
  for (const char* name : {"a.jp", "a", "a.png.txt", "png", ".png", "a.webp"})
    EXPECT_FALSE(HasImageExtension(name)) << name;
}

}  // namespace
}  // namespace oraclegs
