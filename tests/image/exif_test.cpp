#include "oraclegs/image/exif.h"

#include "image/jpeg_files.h"

namespace oraclegs {
namespace {

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
