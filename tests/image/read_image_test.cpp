#include "oraclegs/image/read_image.h"

#include <fstream>
#include <utility>

#include "image/jpeg_files.h"
#include "image/photo_files.h"
#include "oraclegs/core/files.h"
#include "oraclegs/image/codecs.h"
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

using Side = std::pair<int, int>;

TEST(ReadImageSize, NoHeadOfAFileSaysAnotherSize) {
  const TempDir dir;
  const Image8 image = SmoothImage(32, 24, 3);
  EncodeTiff(dir / "a.tif", image);
  struct {
    std::string bytes;
    void (*read)(std::string_view, Side*);
  } const kinds[] = {
      {WithOrientation(EncodeJpeg(image), 8),
       [](std::string_view b, Side* s) { ReadJpegSize(b, "f", Orientation::kUpright, &s->first, &s->second); }},
      {EncodeHeif(image, PhoneExif(6)),
       [](std::string_view b, Side* s) { ReadHeifSize(b, "f", &s->first, &s->second); }},
      {ReadFile(dir / "a.tif"),
       [](std::string_view b, Side* s) { ReadTiffSize(b, "f", Orientation::kUpright, &s->first, &s->second); }}};
  for (const auto& kind : kinds) {
    Side whole;
    kind.read(kind.bytes, &whole);
    for (size_t n = 0; n < kind.bytes.size(); ++n) {
      Side size;
      const std::string_view head = std::string_view(kind.bytes).substr(0, n);
      const bool is_refused = !MessageOf<InputError>([&] { kind.read(head, &size); }).empty();
      EXPECT_TRUE(is_refused || size == whole) << n << " of " << kind.bytes.size();
    }
  }
}

/// Bytes that this process has read from files.
int64_t BytesRead() {
  std::ifstream io("/proc/self/io");
  std::string name;
  int64_t bytes = 0;
  io >> name >> bytes;
  return name == "rchar:" ? bytes : -1;
}

TEST(ReadImageSize, ReadsTheBeginningOfAFile) {
  const TempDir dir;
  Image8 noise = SmoothImage(1500, 1000, 3);
  for (size_t i = 0; i < noise.data.size(); ++i) noise.data[i] = static_cast<uint8_t>(i * i * 2654435761u >> 13);
  WritePng(dir / "a.png", noise);
  std::string jpeg = CompressJpeg(noise, 99);
  WriteText(dir / "a.jpg", jpeg);
  // 70 000 bytes of notes before the size, as color profiles and previews are.
  std::string notes;
  for (int i = 0; i < 2; ++i) notes += std::string("\xFF\xED\x88\xBA", 4) + std::string(0x88BA - 2, 'x');
  WriteText(dir / "notes.jpg", jpeg.insert(2, notes));
  for (const auto& [name, most] :
       {std::pair("a.png", 64 << 10), std::pair("a.jpg", 64 << 10), std::pair("notes.jpg", (1 << 20) + (64 << 10))}) {
    ASSERT_GT(std::filesystem::file_size(dir / name), 2u << 20) << name;
    const int64_t before = BytesRead();
    Side size;
    ReadImageSize(dir / name, &size.first, &size.second);
    EXPECT_EQ(size, Side(1500, 1000)) << name;
    EXPECT_LE(BytesRead() - before, most + 16384) << name;
  }
}

TEST(ReadImageHeader, SaysWhatColmapWouldSeeOtherwise) {
  const TempDir dir;
  const std::string jpeg = EncodeJpeg(SmoothImage(32, 24, 3));
  WriteText(dir / "plain", jpeg);
  WriteText(dir / "turned", WithOrientation(jpeg, 8));
  WriteText(dir / "mirrored", WithOrientation(jpeg, 2));
  WritePng(dir / "rgb", SmoothImage(32, 24, 3));
  WritePng(dir / "rgba", SmoothImage(32, 24, 4));
  const ImageHeader plain = ReadImageHeader(dir / "plain"), turned = ReadImageHeader(dir / "turned"),
                    rgba = ReadImageHeader(dir / "rgba");
  EXPECT_EQ(plain.extension, ".jpg");
  EXPECT_FALSE(plain.is_turned || plain.may_be_transparent);
  EXPECT_TRUE(turned.is_turned);
  EXPECT_EQ(std::pair(turned.width, turned.height), Side(24, 32));
  EXPECT_EQ(std::pair(turned.stored_width, turned.stored_height), Side(32, 24));
  EXPECT_TRUE(ReadImageHeader(dir / "mirrored").is_turned);
  EXPECT_EQ(rgba.extension, ".png");
  EXPECT_TRUE(rgba.may_be_transparent);
  EXPECT_FALSE(ReadImageHeader(dir / "rgb").may_be_transparent);
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

TEST(ReadGrayThumbnail, ReducesEveryFormat) {
  const TempDir dir;
  const Image8 image = SmoothImage(400, 300, 3);
  WriteText(dir / "a.jpg", WithOrientation(EncodeJpeg(image), 6));
  WritePng(dir / "b.png", image);
  WriteText(dir / "c.webp", EncodeWebp(image));
  Image8 cmyk = SmoothImage(400, 300, 4);
  WriteText(dir / "d.jpg", EncodeJpeg(cmyk, {TJPF_CMYK, TJSAMP_444}));
  for (const char* name : {"a.jpg", "b.png", "c.webp", "d.jpg"}) {
    const Image8 small = ReadGrayThumbnail(dir / name, 100);
    EXPECT_EQ(small.width, 100) << name;
    EXPECT_EQ(small.height, 75) << name;
    EXPECT_EQ(small.channels, 1) << name;
  }
  const Image8 a = ReadGrayThumbnail(dir / "a.jpg", 100), b = ReadGrayThumbnail(dir / "b.png", 100);
  for (size_t i = 0; i < a.data.size(); ++i) ASSERT_NEAR(a.data[i], b.data[i], 4) << i;
  EXPECT_EQ(ReadGrayThumbnail(dir / "a.jpg", 1000).width, 400) << "never enlarged";
  WriteText(dir / "e.jpg", EncodeJpeg(image).substr(0, 2000));
  EXPECT_THAT(MessageOf<InputError>([&] { ReadGrayThumbnail(dir / "e.jpg", 100); }), ::testing::HasSubstr("e.jpg"));
}

}  // namespace

}  // namespace oraclegs
