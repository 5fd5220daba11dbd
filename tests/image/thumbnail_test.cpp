#include "oraclegs/image/thumbnail.h"

#include "image/jpeg_files.h"
#include "image/photo_files.h"
#include "oraclegs/image/png.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

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
