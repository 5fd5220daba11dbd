#include "oraclegs/image/codecs.h"

#include "image/jpeg_files.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using ::testing::HasSubstr;

Image8 Decode(const std::string& jpeg, Orientation orientation = Orientation::kUpright) {
  return DecodeJpeg(jpeg, "photo.jpg", orientation);
}

int LargestDifference(const Image8& a, const Image8& b) {
  EXPECT_EQ(a.data.size(), b.data.size());
  int largest = 0;
  for (size_t i = 0; i < std::min(a.data.size(), b.data.size()); ++i) {
    largest = std::max(largest, std::abs(a.data[i] - b.data[i]));
  }
  return largest;
}

TEST(DecodeJpeg, ReadsBaselineAndProgressive) {
  const Image8 image = SmoothImage(61, 47, 3);
  for (const int flags : {0, TJFLAG_PROGRESSIVE}) {
    const Image8 decoded = Decode(EncodeJpeg(image, {.flags = flags}));
    EXPECT_EQ(decoded.width, 61);
    EXPECT_EQ(decoded.height, 47);
    EXPECT_EQ(decoded.channels, 3);
    EXPECT_LE(LargestDifference(decoded, image), 4);
  }
}

TEST(DecodeJpeg, ConvertsGrayToRgb) {
  const Image8 gray = SmoothImage(20, 10, 1);
  const Image8 decoded = Decode(EncodeJpeg(gray, {TJPF_GRAY, TJSAMP_GRAY}));
  ASSERT_EQ(decoded.channels, 3);
  for (size_t i = 0; i < gray.data.size(); ++i) {
    EXPECT_EQ(decoded.data[3 * i], decoded.data[3 * i + 2]);
    EXPECT_NEAR(decoded.data[3 * i], gray.data[i], 2);
  }
}

TEST(DecodeJpeg, ConvertsPlainAndInvertedCmyk) {
  // libjpeg writes the values it gets and adds Adobe's mark, which says that 255 is no ink.
  Image8 cmyk{16, 16, 4, {}};
  for (int i = 0; i < 256; ++i) cmyk.data.insert(cmyk.data.end(), {200, 100, 50, 128});
  std::string jpeg = EncodeJpeg(cmyk, {TJPF_CMYK, TJSAMP_444});
  const Image8 inverted = Decode(jpeg);
  ASSERT_EQ(inverted.channels, 3);
  ASSERT_EQ(inverted.data.size(), 768u);
  EXPECT_NEAR(inverted.data[0], 200 * 128 / 255., 3);
  EXPECT_NEAR(inverted.data[1], 100 * 128 / 255., 3);
  EXPECT_NEAR(inverted.data[2], 50 * 128 / 255., 3);
  // Without the mark the numbers that were stored, luma and chroma of 255 - ink, count as inks themselves.
  const size_t mark = jpeg.find("Adobe");
  ASSERT_NE(mark, std::string::npos);
  const Image8 plain = Decode(jpeg.erase(mark - 4, 16));
  const double luma = 0.299 * 55 + 0.587 * 155 + 0.114 * 205;
  EXPECT_NEAR(plain.data[0], (255 - luma) * (255 - 128) / 255., 3);
}

TEST(DecodeJpeg, AppliesTheOrientationUnlessAsStored) {
  const Image8 image = SmoothImage(40, 24, 3);
  const std::string plain = EncodeJpeg(image);
  const Image8 stored = Decode(plain);
  for (int orientation = 1; orientation <= 8; ++orientation) {
    const std::string jpeg = WithOrientation(plain, orientation);
    const Image8 upright = Decode(jpeg);
    EXPECT_EQ(upright.width, orientation < 5 ? 40 : 24);
    int width = 0, height = 0;
    ReadJpegSize(jpeg, "photo.jpg", Orientation::kUpright, &width, &height);
    EXPECT_EQ(width, upright.width);
    EXPECT_EQ(height, upright.height);
    EXPECT_EQ(Decode(jpeg, Orientation::kAsStored).data, stored.data);
  }
  const Image8 turned = Decode(WithOrientation(plain, 6));  // stored a quarter turn to the left
  for (int c = 0; c < 3; ++c)
    EXPECT_EQ(turned.data[23 * 3 + static_cast<size_t>(c)], stored.data[static_cast<size_t>(c)]);
}

TEST(DecodeJpeg, NamesATruncatedFile) {
  const std::string jpeg = EncodeJpeg(SmoothImage(160, 120, 3));
  for (const double share : {0.001, 0.01, 0.1, 0.5, 0.9, 0.99}) {
    const std::string part = jpeg.substr(0, std::max<size_t>(3, static_cast<size_t>(share * jpeg.size())));
    EXPECT_THAT(MessageOf<InputError>([&] { Decode(part); }), HasSubstr("photo.jpg: "));
  }
}

TEST(DecodeJpeg, RefusesDamageInTheScan) {
  const std::string jpeg = EncodeJpeg(SmoothImage(64, 64, 3));
  int refused = 0;
  for (size_t i = 2; i < jpeg.size(); i += 7) {
    std::string damaged = jpeg;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x5A);
    try {
      const Image8 image = Decode(damaged);
      EXPECT_EQ(image.data.size(), static_cast<size_t>(image.width * image.height * 3));
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 10);
}

TEST(DecodeJpeg, IgnoresBytesAfterTheScan) {
  std::string jpeg = EncodeJpeg(SmoothImage(64, 64, 3));
  const Image8 whole = Decode(jpeg);
  jpeg.insert(jpeg.size() - 2, 5, '\0');
  EXPECT_EQ(Decode(jpeg).data, whole.data);
  EXPECT_EQ(Decode(jpeg + "trailer of a motion photo").data, whole.data);
}

TEST(DecodeJpeg, RefusesAHeaderThatExceedsItsBytes) {
  std::string jpeg = EncodeJpeg(SmoothImage(16, 16, 3));
  const size_t frame = jpeg.find("\xFF\xC0");
  ASSERT_NE(frame, std::string::npos);
  const auto with_size = [&](unsigned width, unsigned height) {
    std::string changed = jpeg;
    changed[frame + 5] = static_cast<char>(height >> 8);
    changed[frame + 6] = static_cast<char>(height & 255);
    changed[frame + 7] = static_cast<char>(width >> 8);
    changed[frame + 8] = static_cast<char>(width & 255);
    return changed;
  };
  EXPECT_THAT(MessageOf<InputError>([&] { Decode(with_size(65500, 65500)); }),
              HasSubstr("photo.jpg: its header says 65500 x"));
  EXPECT_THAT(MessageOf<InputError>([&] { Decode(with_size(9000, 9000)); }), HasSubstr("more than its bytes can hold"));
  EXPECT_THAT(MessageOf<InputError>([&] { Decode(with_size(0, 16)); }), HasSubstr("photo.jpg"));
}

TEST(CompressJpeg, IsReadBack) {
  for (const int channels : {1, 3}) {
    const Image8 image = SmoothImage(61, 47, channels);
    const Image8 decoded = Decode(CompressJpeg(image, 92));
    EXPECT_EQ(decoded.width, 61);
    EXPECT_EQ(decoded.height, 47);
    for (size_t i = 0; i < image.data.size(); ++i) {
      EXPECT_NEAR(decoded.data[channels == 1 ? 3 * i : i], image.data[i], 12);
    }
  }
  const Image8 image = SmoothImage(61, 47, 3);
  EXPECT_LT(CompressJpeg(image, 30).size(), CompressJpeg(image, 95).size());
}

}  // namespace
}  // namespace oraclegs
