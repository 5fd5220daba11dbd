#include "oraclegs/image/exif.h"

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

/// 3 x 2, each pixel its own number:   0 1 2
///                                     3 4 5
Image8 Numbered() { return {3, 2, 1, {0, 1, 2, 3, 4, 5}}; }

struct OrientationCase {
  int orientation, width;
  std::vector<uint8_t> upright;
};

TEST(ApplyOrientation, UndoesEveryOrientation) {
  // What EXIF says about the stored image's first row and first column: 1 top left, 2 top right, 3 bottom right,
  // 4 bottom left, 5 left top, 6 right top, 7 right bottom, 8 left bottom.
  const OrientationCase cases[] = {{1, 3, {0, 1, 2, 3, 4, 5}}, {2, 3, {2, 1, 0, 5, 4, 3}}, {3, 3, {5, 4, 3, 2, 1, 0}},
                                   {4, 3, {3, 4, 5, 0, 1, 2}}, {5, 2, {0, 3, 1, 4, 2, 5}}, {6, 2, {3, 0, 4, 1, 5, 2}},
                                   {7, 2, {5, 2, 4, 1, 3, 0}}, {8, 2, {2, 5, 1, 4, 0, 3}}};
  for (const OrientationCase& c : cases) {
    const Image8 upright = ApplyOrientation(Numbered(), c.orientation);
    EXPECT_EQ(upright.width, c.width);
    EXPECT_EQ(upright.height, 5 - c.width);
    EXPECT_EQ(upright.data, c.upright) << c.orientation;
    EXPECT_EQ(SwapsAxes(c.orientation), c.width == 2);
  }
}

TEST(ApplyOrientation, KeepsChannelsTogether) {
  const Image8 pair{2, 1, 3, {1, 2, 3, 4, 5, 6}};
  EXPECT_EQ(ApplyOrientation(pair, 2).data, (std::vector<uint8_t>{4, 5, 6, 1, 2, 3}));
}

TEST(ReadJpegMetadata, ReadsBothByteOrders) {
  for (const bool big_endian : {false, true}) {
    for (int orientation = 1; orientation <= 8; ++orientation) {
      const std::string jpeg = "\xFF\xD8" + ExifSegment(orientation, big_endian) + "\xFF\xD9";
      EXPECT_EQ(ReadJpegMetadata(jpeg).orientation, orientation) << big_endian;
    }
  }
}

TEST(ReadJpegMetadata, SkipsOtherSegmentsAndFillBytes) {
  const std::string other(
      "\xFF\xE0\x00\x05"
      "abc",
      7);
  const std::string adobe(
      "\xFF\xEE\x00\x0E"
      "Adobe\0\0\0\0\0\0\0",
      16);
  const JpegMetadata metadata = ReadJpegMetadata("\xFF\xD8" + other + "\xFF\xFF" + ExifSegment(6, true) + adobe);
  EXPECT_EQ(metadata.orientation, 6);
  EXPECT_TRUE(metadata.has_adobe_mark);
}

TEST(ReadJpegMetadata, StopsAtTheScan) {
  const std::string scan("\xFF\xDA\x00\x02", 4);
  EXPECT_EQ(ReadJpegMetadata("\xFF\xD8" + scan + ExifSegment(6, true)).orientation, 1);
}

TEST(ReadJpegMetadata, TakesDamageAsUpright) {
  const std::string whole = "\xFF\xD8" + ExifSegment(6, false) + "\xFF\xD9";
  for (size_t length = 0; length < whole.size(); ++length) {
    const int orientation = ReadJpegMetadata(std::string_view(whole).substr(0, length)).orientation;
    EXPECT_TRUE(orientation == 1 || length >= whole.size() - 2) << length;
  }
  for (size_t i = 2; i < whole.size(); ++i) {  // any byte, any value: the answer is one of the eight
    for (const int value : {0, 1, 9, 0x7F, 0x80, 0xFF}) {
      std::string damaged = whole;
      damaged[i] = static_cast<char>(value);
      const int orientation = ReadJpegMetadata(damaged).orientation;
      EXPECT_TRUE(orientation >= 1 && orientation <= 8) << i << " " << value;
    }
  }
}

TEST(ReadJpegMetadata, TakesInvalidOrientationsAsUpright) {
  EXPECT_EQ(ReadJpegMetadata("\xFF\xD8" + ExifSegment(0, false)).orientation, 1);
  EXPECT_EQ(ReadJpegMetadata("\xFF\xD8" + ExifSegment(9, false)).orientation, 1);
}

}  // namespace
}  // namespace oraclegs
