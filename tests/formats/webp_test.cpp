#include "oraclegs/formats/webp.h"

#include "support/errors.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

ByteImage Noise(int width, int height) {
  ByteImage image{width, height, {}};
  uint32_t state = 1;
  for (int i = 0; i < 4 * width * height; ++i)
    image.rgba.push_back(static_cast<uint8_t>((state = state * 69069 + 1) >> 24));
  return image;
}

TEST(Webp, IsLosslessAlsoWhereItIsTransparent) {
  ByteImage image = Noise(37, 21);
  for (size_t i = 3; i < image.rgba.size(); i += 8) image.rgba[i] = 0;
  const ByteImage read = DecodeWebp(EncodeWebp(image), 37 * 21, "a.webp");
  EXPECT_EQ(read.width, 37);
  EXPECT_EQ(read.height, 21);
  EXPECT_EQ(read.rgba, image.rgba);
}

TEST(Webp, RefusesWhatCannotBe) {
  const std::string bytes = EncodeWebp(Noise(16, 16));
  const auto error = [](const std::string& b, int64_t most) {
    return MessageOf<InputError>([&] { DecodeWebp(b, most, "a.webp"); });
  };
  EXPECT_THAT(error("RIFF", 999), HasSubstr("a.webp: is not a WebP image"));
  EXPECT_THAT(error(bytes, 255), HasSubstr("16 x 16 pixels"));
  EXPECT_THAT(error(bytes.substr(0, bytes.size() / 2), 999), HasSubstr("damaged"));
  EXPECT_THAT(MessageOf<RunError>([] { EncodeWebp({20000, 1, std::vector<uint8_t>(80000)}); }), HasSubstr("20000 x 1"));
}

}  // namespace
}  // namespace oraclegs
