#include "oraclegs/image/codecs.h"

#include "image/jpeg_files.h"
#include "image/photo_files.h"
#include "oraclegs/image/exif.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using ::testing::HasSubstr;

Image8 DecodedTiff(const std::string& bytes, Orientation orientation = Orientation::kUpright) {
  return DecodeTiff(bytes, "a.tif", orientation);
}

TEST(DecodeTiff, GivesTheImageBack) {
  const TempDir dir;
  const Image8 image = SmoothImage(20, 30, 3);
  for (const int bits : {8, 16}) {
    for (const uint16_t compression : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE}) {
      const std::string bytes = EncodeTiff(dir / "a.tif", image, {bits, 1, compression});
      ASSERT_TRUE(IsTiff(bytes));
      EXPECT_EQ(DecodedTiff(bytes).data, image.data) << bits << " " << compression;
    }
  }
}

TEST(DecodeTiff, AppliesEveryOrientation) {
  const TempDir dir;
  const Image8 image = SmoothImage(20, 12, 3);
  for (uint16_t orientation = 1; orientation <= 8; ++orientation) {
    const std::string bytes = EncodeTiff(dir / "a.tif", image, {8, orientation});
    EXPECT_EQ(DecodedTiff(bytes).data, ApplyOrientation(image, orientation).data) << orientation;
    EXPECT_EQ(DecodedTiff(bytes, Orientation::kAsStored).data, image.data) << orientation;
    int width = 0, height = 0;
    ReadTiffSize(bytes, "a.tif", Orientation::kUpright, &width, &height);
    EXPECT_EQ(width, orientation > 4 ? 12 : 20);
    EXPECT_EQ(height, orientation > 4 ? 20 : 12);
  }
}

TEST(DecodeTiff, KeepsTransparency) {
  const TempDir dir;
  Image8 image{2, 1, 4, {200, 100, 50, 255, 200, 100, 50, 128}};
  const Image8 read = DecodedTiff(EncodeTiff(dir / "a.tif", image));
  ASSERT_EQ(read.channels, 4);
  for (size_t i = 0; i < 8; ++i) EXPECT_NEAR(read.data[i], image.data[i], 2) << i;
  image.data[7] = 255;
  EXPECT_EQ(DecodedTiff(EncodeTiff(dir / "a.tif", image)).channels, 3);
}

TEST(DecodeTiff, NamesADamagedFile) {
  const TempDir dir;
  const std::string bytes = EncodeTiff(dir / "a.tif", SmoothImage(40, 30, 3));
  EXPECT_THAT(MessageOf<InputError>([&] { DecodedTiff(bytes.substr(0, bytes.size() / 2)); }),
              HasSubstr("a.tif: is a damaged"));
  EXPECT_THAT(MessageOf<InputError>([&] { DecodedTiff(std::string("II*\0", 4)); }), HasSubstr("a.tif"));
}

TEST(DecodeTiff, SurvivesAnyDamage) {
  const TempDir dir;
  for (const int bits : {8, 16}) {
    DecodeDamaged(EncodeTiff(dir / "a.tif", SmoothImage(20, 12, 4), {bits, 6}),
                  [](const std::string& damaged) { DecodedTiff(damaged); });
  }
}

}  // namespace
}  // namespace oraclegs
