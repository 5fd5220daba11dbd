#include "oraclegs/image/codecs.h"

#include "image/jpeg_files.h"
#include "image/photo_files.h"
#include "oraclegs/image/exif.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

using ::testing::HasSubstr;

TEST(DecodeWebp, GivesTheImageBack) {
  for (const int channels : {3, 4}) {
    Image8 image = SmoothImage(20, 12, channels);
    if (channels == 4) std::fill(image.data.begin(), image.data.begin() + 8, uint8_t{200});
    const std::string bytes = EncodeWebp(image);
    ASSERT_TRUE(IsWebp(bytes));
    const Image8 read = DecodeWebp(bytes, "a.webp", Orientation::kUpright);
    EXPECT_EQ(read.channels, channels);
    if (channels == 3) {
      EXPECT_EQ(read.data, image.data);
    }
  }
}

TEST(DecodeWebp, AppliesTheExifOrientation) {
  const Image8 image = SmoothImage(20, 12, 3);
  const std::string bytes = EncodeWebp(image, PhoneExif(6));
  EXPECT_EQ(DecodeWebp(bytes, "a.webp", Orientation::kUpright).data, ApplyOrientation(image, 6).data);
  EXPECT_EQ(DecodeWebp(bytes, "a.webp", Orientation::kAsStored).data, image.data);
  int width = 0, height = 0;
  ReadWebpSize(bytes, "a.webp", Orientation::kUpright, &width, &height);
  EXPECT_EQ(width, 12);
  EXPECT_EQ(height, 20);
}

TEST(DecodeWebp, NamesADamagedFile) {
  const std::string bytes = EncodeWebp(SmoothImage(20, 12, 3));
  const auto read = [](const std::string& damaged) { DecodeWebp(damaged, "a.webp", Orientation::kUpright); };
  EXPECT_THAT(MessageOf<InputError>([&] { read(bytes.substr(0, bytes.size() / 2)); }),
              HasSubstr("a.webp: is a damaged or incomplete WebP"));
  EXPECT_THAT(MessageOf<InputError>([&] { read("RIFF1234WEBPnonsense"); }), HasSubstr("a.webp"));
  DecodeDamaged(bytes, read);
  DecodeDamaged(EncodeWebp(SmoothImage(20, 12, 4), PhoneExif(8)), read);
}

}  // namespace
}  // namespace oraclegs
