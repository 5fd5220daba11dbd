#include "oraclegs/image/codecs.h"

#include "image/heif_boxes.h"
#include "image/jpeg_files.h"
#include "image/photo_files.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using ::testing::HasSubstr;

/// Mean difference of two images of one size.
double MeanDifference(const Image8& a, const Image8& b) {
  EXPECT_EQ(a.data.size(), b.data.size());
  double sum = 0;
  for (size_t i = 0; i < std::min(a.data.size(), b.data.size()); ++i) sum += std::abs(a.data[i] - b.data[i]);
  return sum / static_cast<double>(std::max<size_t>(1, a.data.size()));
}

TEST(DecodeHeif, GivesTheImageBack) {
  for (const auto format : {heif_compression_HEVC, heif_compression_AV1}) {
    for (const int channels : {3, 4}) {
      Image8 image = SmoothImage(64, 48, channels);
      const std::string bytes = EncodeHeif(image, "", format);
      ASSERT_FALSE(bytes.empty()) << "libheif of the tests has encoders";
      ASSERT_TRUE(IsHeif(bytes));
      const Image8 read = DecodeHeif(bytes, "a.heic");
      EXPECT_EQ(read.width, 64);
      EXPECT_EQ(read.height, 48);
      EXPECT_EQ(read.channels, channels);
      EXPECT_LT(MeanDifference(read, image), 4);
      int width = 0, height = 0;
      ReadHeifSize(bytes, "a.heic", &width, &height);
      EXPECT_EQ(width, 64);
      EXPECT_EQ(height, 48);
    }
  }
}

TEST(DecodeHeif, IgnoresTheExifOrientation) {
  // The container has its own way to turn an image, and the EXIF tag repeats it.
  const Image8 image = SmoothImage(64, 32, 3);
  const Image8 read = DecodeHeif(EncodeHeif(image, PhoneExif(6)), "a.heic");
  EXPECT_EQ(read.width, 64);
  EXPECT_LT(MeanDifference(read, image), 4);
}

TEST(DecodeHeif, NamesADamagedFile) {
  const std::string bytes = EncodeHeif(SmoothImage(64, 48, 3));
  EXPECT_THAT(MessageOf<InputError>([&] { DecodeHeif(bytes.substr(0, bytes.size() / 2), "a.heic"); }),
              HasSubstr("a.heic: is a damaged or incomplete HEIF image"));
  EXPECT_FALSE(IsHeif("RIFFxxxxWEBP"));
}

TEST(DecodeHeif, SurvivesAnyDamage) {
  const std::string bytes = EncodeHeif(SmoothImage(32, 32, 3), PhoneExif());
  DecodeDamaged(bytes, [](const std::string& damaged) {
    int width = 0, height = 0;
    ReadHeifSize(damaged, "a.heic", &width, &height);
    const Image8 image = DecodeHeif(damaged, "a.heic");
    EXPECT_EQ(image.width, width);
    EXPECT_EQ(image.data.size(), static_cast<size_t>(width) * height * image.channels);
  });
}

TEST(ReadHeifExif, GivesTheTiffStructure) {
  const std::string tiff = PhoneExif();
  EXPECT_EQ(ReadHeifExif(EncodeHeif(SmoothImage(32, 32, 3), tiff)), tiff);
  EXPECT_EQ(ReadHeifExif(EncodeHeif(SmoothImage(32, 32, 3))), "");
  EXPECT_EQ(ReadHeifExif("nonsense"), "");
}

TEST(DecodeHeif, TakesNoMemoryForPartsLargerThanTheImage) {
  const std::string bytes = GridFile(33000, 61000, HeifReference("dimg", 2, {1}));  // 2 GB a channel
  int width = 0, height = 0;
  ReadHeifSize(bytes, "a.heic", &width, &height);
  EXPECT_EQ(width, 16);
  EXPECT_THAT(MessageOf<InputError>([&] { DecodeHeif(bytes, "a.heic"); }), HasSubstr("Security limit exceeded"));
}

using ::testing::HasSubstr;

bool IsFinite(const std::string& references) { return HasFinitePieces(GridFile(16, 8, references)); }

TEST(HasFinitePieces, AcceptsPhotos) {
  EXPECT_TRUE(HasFinitePieces(EncodeHeif(SmoothImage(16, 8, 4), PhoneExif())));
  EXPECT_TRUE(IsFinite(""));
  EXPECT_TRUE(IsFinite(HeifReference("dimg", 2, {1, 1, 1}) + HeifReference("auxl", 3, {2})));
  EXPECT_TRUE(IsFinite(HeifReference("cdsc", 2, {2}))) << "what describes is not decoded";
  EXPECT_TRUE(HasFinitePieces(""));
}

TEST(HasFinitePieces, RefusesCircles) {
  EXPECT_FALSE(IsFinite(HeifReference("dimg", 2, {2})));
  EXPECT_FALSE(IsFinite(HeifReference("dimg", 2, {1}) + HeifReference("dimg", 1, {2})));
  EXPECT_FALSE(IsFinite(HeifReference("auxl", 2, {2})));
  EXPECT_FALSE(IsFinite(HeifReference("dimg", 2, {1}) + HeifReference("auxl", 2, {1})));
  EXPECT_THAT(MessageOf<InputError>([] { DecodeHeif(GridFile(16, 8, HeifReference("dimg", 2, {2})), "a.heic"); }),
              HasSubstr("a.heic: is a damaged HEIF image (made of itself"));
}

TEST(HasFinitePieces, RefusesManifoldsOfManifolds) {
  std::string references;
  for (uint64_t id = 2; id < 8; ++id) references += HeifReference("dimg", id, std::vector<uint64_t>(10, id + 1));
  EXPECT_FALSE(IsFinite(references)) << "a million";
  EXPECT_TRUE(IsFinite(HeifReference("dimg", 2, std::vector<uint64_t>(2000, 1))));
}

}  // namespace

}  // namespace oraclegs
