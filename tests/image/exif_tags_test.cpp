#include "oraclegs/image/exif_tags.h"

#include "image/jpeg_files.h"
#include "image/photo_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

void ExpectPhone(const Exif& exif, const char* container) {
  EXPECT_EQ(exif.make, "Maker") << container;
  EXPECT_EQ(exif.model, "Phone 9") << container;
  EXPECT_EQ(exif.date, "2026:11:23 10:00:00") << container;
  EXPECT_DOUBLE_EQ(exif.focal_mm, 5.1) << container;
  EXPECT_DOUBLE_EQ(exif.focal_35mm, 26) << container;
  ASSERT_TRUE(exif.gps) << container;
  EXPECT_NEAR(exif.gps->latitude, 47.51, 1e-9) << container;
  EXPECT_NEAR(exif.gps->longitude, -8.25, 1e-9) << container;
  EXPECT_NEAR(exif.gps->altitude.value_or(0), 410.5, 1e-9) << container;
}

std::string PngWithExif(const std::string& tiff) {
  const auto be = [](size_t n) {
    return std::string{static_cast<char>(n >> 24), static_cast<char>(n >> 16), static_cast<char>(n >> 8),
                       static_cast<char>(n)};
  };
  return std::string("\x89PNG\r\n\x1a\n", 8) + be(3) + "IHDRabcCCCC" + be(tiff.size()) + "eXIf" + tiff + "CCCC";
}

TEST(ReadExif, ReadsEveryContainer) {
  const Image8 image = SmoothImage(24, 16, 3);
  const std::string tiff = PhoneExif(6);
  ExpectPhone(ReadExif(WithExif(EncodeJpeg(image), tiff)), "JPEG");
  ExpectPhone(ReadExif(PngWithExif(tiff)), "PNG");
  ExpectPhone(ReadExif(EncodeWebp(image, tiff)), "WebP");
  ExpectPhone(ReadExif(tiff), "TIFF");
  ExpectPhone(ReadExif(EncodeHeif(image, tiff)), "HEIC");
  EXPECT_EQ(ReadExif(tiff).orientation, 6);
}

TEST(ReadExif, IsEmptyWithoutABlock) {
  const Image8 image = SmoothImage(24, 16, 3);
  for (const std::string& file : {EncodeJpeg(image), EncodeWebp(image), EncodeHeif(image), std::string("text")}) {
    const Exif exif = ReadExif(file);
    EXPECT_EQ(exif.orientation, 1);
    EXPECT_FALSE(exif.HasCamera());
    EXPECT_FALSE(exif.gps);
  }
}

TEST(ReadExif, TakesAnyDamage) {
  const std::string tiff = PhoneExif(6);
  for (const std::string& file : {tiff, ExifSegmentOf(tiff), PngWithExif(tiff), EncodeWebp(SmoothImage(8, 8, 3), tiff),
                                  EncodeHeif(SmoothImage(16, 16, 3), tiff)}) {
    DecodeDamaged(file, [](const std::string& bytes) {
      const Exif exif = ReadExif(bytes);
      EXPECT_GE(exif.orientation, 1);
      EXPECT_LE(exif.orientation, 8);
      EXPECT_GT(FocalPixels(exif, 4000, 3000).value_or(1), 0);
    });
  }
}

TEST(FocalPixels, FollowsTheSizeOfTheImage) {
  const Exif phone = ParseExif(PhoneExif());
  EXPECT_NEAR(FocalPixels(phone, 4000, 3000).value_or(0), 26 / 43.2666 * 5000, 1e-6);
  EXPECT_NEAR(FocalPixels(phone, 750, 1000).value_or(0), 26 / 43.2666 * 1250, 1e-6);
  EXPECT_FALSE(FocalPixels(Exif{}, 4000, 3000));

  Exif sensor;
  sensor.focal_mm = 50;
  sensor.pixels_per_mm = 160;
  EXPECT_FALSE(FocalPixels(sensor, 6000, 4000)) << "of which size?";
  sensor.pixel_width = 6000;
  sensor.pixel_height = 4000;
  EXPECT_DOUBLE_EQ(FocalPixels(sensor, 6000, 4000).value_or(0), 8000);
  EXPECT_DOUBLE_EQ(FocalPixels(sensor, 2000, 3000).value_or(0), 4000);
  sensor.focal_mm = 1e9;
  EXPECT_FALSE(FocalPixels(sensor, 6000, 4000)) << "no lens";
}

TEST(ParseExif, KnowsTheUnitsOfTheSensor) {
  for (const auto& [unit, pixels] : {std::pair{2u, 100.0}, {3u, 254.0}, {4u, 2540.0}}) {
    ExifMaker exif, details;
    details.Rationals(0xA20E, {{2540, 1}});
    details.Short(0xA210, unit);
    exif.Sub(0x8769, details);
    EXPECT_NEAR(ParseExif(exif.Tiff()).pixels_per_mm, pixels, 1e-9) << unit;
  }
}

TEST(ParseExif, IgnoresDirectoriesAtNegativePlaces) {
  for (const unsigned tag : {0x8769u, 0x8825u}) {
    ExifMaker exif;
    exif.Text(0x010F, "Maker");
    exif.Rationals(tag, {{0xFFFFFFFF, 1}});  // -1 where it is signed
    std::string tiff = exif.Tiff();
    const size_t type = tiff.find(ExifMaker::Number(tag, 2)) + 2;
    tiff[type] = 10;
    EXPECT_EQ(ParseExif(tiff).make, "Maker");
    EXPECT_FALSE(ParseExif(tiff).gps);
  }
}

}  // namespace
}  // namespace oraclegs
