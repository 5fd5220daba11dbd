#include "oraclegs/image/codecs.h"

#include "oraclegs/core/files.h"

#include <png.h>

#include "image/jpeg_files.h"
#include "oraclegs/image/read_image.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct PngFile {
  int width, height, depth, color;
  std::vector<uint8_t> data;  ///< rows as PNG stores them
  int interlace = PNG_INTERLACE_NONE;
  std::vector<png_color> palette;
  std::vector<uint8_t> palette_alpha;
};

std::string EncodePng(const PngFile& file) {
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &bytes,
      [](png_structp p, png_bytep data, size_t count) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<char*>(data), count);
      },
      nullptr);
  png_set_IHDR(png, info, static_cast<png_uint_32>(file.width), static_cast<png_uint_32>(file.height), file.depth,
               file.color, file.interlace, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (!file.palette.empty()) png_set_PLTE(png, info, file.palette.data(), static_cast<int>(file.palette.size()));
  if (!file.palette_alpha.empty()) {
    png_set_tRNS(png, info, file.palette_alpha.data(), static_cast<int>(file.palette_alpha.size()), nullptr);
  }
  std::vector<png_bytep> rows;
  const size_t row_bytes = file.data.size() / static_cast<size_t>(file.height);
  for (int y = 0; y < file.height; ++y) {
    rows.push_back(const_cast<png_bytep>(file.data.data()) + static_cast<size_t>(y) * row_bytes);
  }
  png_set_rows(png, info, rows.data());
  png_write_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

Image8 DecodeUpright(const std::string& bytes) { return DecodePng(bytes, "photo.png"); }

TEST(DecodePng, ReadsRgbAndRgbaExactly) {
  for (const int interlace : {PNG_INTERLACE_NONE, PNG_INTERLACE_ADAM7}) {
    for (const int channels : {3, 4}) {
      const Image8 image = SmoothImage(19, 13, channels);
      const Image8 decoded = DecodeUpright(EncodePng(
          {19, 13, 8, channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGB_ALPHA, image.data, interlace, {}, {}}));
      EXPECT_EQ(decoded.width, 19);
      EXPECT_EQ(decoded.height, 13);
      EXPECT_EQ(decoded.channels, channels);
      EXPECT_EQ(decoded.data, image.data);
    }
  }
}

TEST(DecodePng, ConvertsAPaletteToRgb) {
  const PngFile file{2, 1, 8, PNG_COLOR_TYPE_PALETTE, {1, 0}, PNG_INTERLACE_NONE, {{10, 20, 30}, {40, 50, 60}}, {}};
  const Image8 decoded = DecodeUpright(EncodePng(file));
  EXPECT_EQ(decoded.channels, 3);
  EXPECT_THAT(decoded.data, ElementsAre(40, 50, 60, 10, 20, 30));
}

TEST(DecodePng, ConvertsPaletteTransparencyToAlpha) {
  const PngFile file{2, 1, 8, PNG_COLOR_TYPE_PALETTE, {1, 0}, PNG_INTERLACE_NONE, {{10, 20, 30}, {40, 50, 60}}, {7}};
  const Image8 decoded = DecodeUpright(EncodePng(file));
  EXPECT_EQ(decoded.channels, 4);
  EXPECT_THAT(decoded.data, ElementsAre(40, 50, 60, 255, 10, 20, 30, 7));
}

TEST(DecodePng, RoundsSixteenBitsToEight) {
  const std::vector<uint8_t> data{0x00, 0x00, 0x80, 0x00, 0xFF, 0xFF, 0x01, 0x7F, 0x12, 0x34, 0x00, 0x81};
  const Image8 decoded = DecodeUpright(EncodePng({2, 1, 16, PNG_COLOR_TYPE_RGB, data, PNG_INTERLACE_NONE, {}, {}}));
  EXPECT_EQ(decoded.channels, 3);
  EXPECT_THAT(decoded.data, ElementsAre(0, 128, 255, 1, 18, 1));  // round(value / 257)
}

TEST(DecodePng, ConvertsGrayToColor) {
  const Image8 gray = DecodeUpright(EncodePng({2, 1, 8, PNG_COLOR_TYPE_GRAY, {9, 200}, PNG_INTERLACE_NONE, {}, {}}));
  EXPECT_THAT(gray.data, ElementsAre(9, 9, 9, 200, 200, 200));
  const Image8 alpha =
      DecodeUpright(EncodePng({2, 1, 8, PNG_COLOR_TYPE_GRAY_ALPHA, {9, 1, 200, 2}, PNG_INTERLACE_NONE, {}, {}}));
  EXPECT_EQ(alpha.channels, 4);
  EXPECT_THAT(alpha.data, ElementsAre(9, 9, 9, 1, 200, 200, 200, 2));
  const Image8 bits =
      DecodeUpright(EncodePng({4, 1, 1, PNG_COLOR_TYPE_GRAY, {0b10100000}, PNG_INTERLACE_NONE, {}, {}}));
  EXPECT_THAT(bits.data, ElementsAre(255, 255, 255, 0, 0, 0, 255, 255, 255, 0, 0, 0));
}

TEST(DecodePng, NamesATruncatedFile) {
  const std::string whole = EncodePng({19, 13, 8, PNG_COLOR_TYPE_RGB, SmoothImage(19, 13, 3).data, 0, {}, {}});
  for (size_t length = 8; length < whole.size(); length += 3) {
    EXPECT_THAT(MessageOf<InputError>([&] { DecodeUpright(whole.substr(0, length)); }), HasSubstr("photo.png: "))
        << length;
  }
}

TEST(DecodePng, RefusesADamagedByte) {
  const std::string whole = EncodePng({19, 13, 8, PNG_COLOR_TYPE_RGB, SmoothImage(19, 13, 3).data, 0, {}, {}});
  for (size_t i = 8; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    EXPECT_THAT(MessageOf<InputError>([&] { DecodeUpright(damaged); }), HasSubstr("photo.png: ")) << i;
  }
}

TEST(DecodePng, RefusesAHeaderThatExceedsItsBytes) {
  std::string png = EncodePng({19, 13, 8, PNG_COLOR_TYPE_RGB, SmoothImage(19, 13, 3).data, 0, {}, {}});
  const auto with_width = [&png](std::string width) { return png.replace(16, 4, width); };
  EXPECT_THAT(MessageOf<InputError>([&] { DecodeUpright(with_width("\x7F\xFF\xFF\xFF")); }),
              HasSubstr("photo.png: its header says 2147483647 x 13 pixels"));
  EXPECT_THAT(MessageOf<InputError>([&] { DecodeUpright(with_width("\xFF\xFF\xFF\xFF")); }),
              HasSubstr("4294967295 x 13"));
  EXPECT_THAT(MessageOf<InputError>([&] { DecodeUpright(with_width(std::string("\x00\xFF\xFF\xFF", 4))); }),
              HasSubstr("more than its bytes can hold"));
  EXPECT_THAT(MessageOf<InputError>([&] { DecodeUpright(with_width(std::string(4, '\0'))); }), HasSubstr("0 x 13"));
}

TEST(DecodePng, PassesOverChunksThatAreNotOfThePixels) {
  const Image8 image = SmoothImage(4, 3, 3);
  const TempDir dir;
  WritePng(dir / "a.png", image);
  const std::string plain = ReadFile(dir / "a.png");
  for (const char* name : {"eXIf", "zTXt", "iCCP", "sPLT", "abCd"}) {
    const std::string chunk = std::string("\0\0\0\4", 4) + name + "\1\2\3\4crc!";
    EXPECT_EQ(DecodeUpright(plain.substr(0, 33) + chunk + plain.substr(33)).data, image.data) << name;
    // libpng would take the memory that its length asks for.
    const std::string longer = std::string("\x60\x80\0\1", 4) + name + "\1\2\3\4crc!";
    EXPECT_THAT(MessageOf<InputError>([&] { DecodeUpright(plain.substr(0, 33) + longer + plain.substr(33)); }),
                HasSubstr("the file ends too early"));
  }
}

TEST(WritePng, RoundTrips) {
  const TempDir dir;
  for (const int channels : {1, 3, 4}) {
    const Image8 image = SmoothImage(23, 17, channels);
    WritePng(dir / "new" / "image.png", image);
    const Image8 read = ReadImage(dir / "new" / "image.png");
    ASSERT_EQ(read.channels, channels == 1 ? 3 : channels);
    for (size_t i = 0; i < image.data.size(); ++i) {
      EXPECT_EQ(read.data[channels == 1 ? 3 * i : i], image.data[i]);
    }
  }
}

TEST(WritePng16, IsBigEndian) {
  const TempDir dir;
  WritePng16(dir / "depth.png", 2, 2, {0, 257, 0x8000, 0xFFFF});
  const Image8 read = ReadImage(dir / "depth.png");
  EXPECT_THAT(read.data, ElementsAre(0, 0, 0, 1, 1, 1, 128, 128, 128, 255, 255, 255));
}

TEST(ReadPng16, RoundTrips) {
  const TempDir dir;
  std::vector<uint16_t> values;
  for (int i = 0; i < 7 * 5; ++i) values.push_back(static_cast<uint16_t>(1871 * i));
  WritePng16(dir / "depth.png", 7, 5, values);
  const Image16 read = ReadPng16(dir / "depth.png");
  EXPECT_EQ(read.width, 7);
  EXPECT_EQ(read.height, 5);
  EXPECT_EQ(read.values, values);
}

TEST(ReadPng16, RefusesOtherKindsOfPng) {
  const TempDir dir;
  const std::vector<uint8_t> bytes(2 * 4 * 4 * 3, 7);
  const auto some = [&](size_t count) { return std::vector<uint8_t>(bytes.begin(), bytes.begin() + count); };
  const std::vector<PngFile> others = {
      {4, 4, 8, PNG_COLOR_TYPE_GRAY, some(16), PNG_INTERLACE_NONE, {}, {}},
      {4, 4, 8, PNG_COLOR_TYPE_GRAY_ALPHA, some(32), PNG_INTERLACE_NONE, {}, {}},  // rows as long as those wanted
      {4, 4, 16, PNG_COLOR_TYPE_RGB, some(96), PNG_INTERLACE_NONE, {}, {}},
      {4, 4, 16, PNG_COLOR_TYPE_GRAY, some(32), PNG_INTERLACE_ADAM7, {}, {}},
  };
  for (const PngFile& file : others) {
    WriteText(dir / "other.png", EncodePng(file));
    EXPECT_THAT(MessageOf<InputError>([&] { ReadPng16(dir / "other.png"); }),
                ::testing::AllOf(HasSubstr("other.png: "), HasSubstr("16 bits")));
  }
}

TEST(ReadPng16, NamesADamagedFile) {
  const TempDir dir;
  WritePng16(dir / "depth.png", 7, 5, std::vector<uint16_t>(35, 12345));
  const std::string whole = ReadFile(dir / "depth.png");
  for (size_t length = 0; length < whole.size(); length += 3) {
    WriteText(dir / "cut.png", whole.substr(0, length));
    EXPECT_THAT(MessageOf<InputError>([&] { ReadPng16(dir / "cut.png"); }), HasSubstr("cut.png: ")) << length;
  }
  WriteText(dir / "cut.png", "no image");
  EXPECT_THAT(MessageOf<InputError>([&] { ReadPng16(dir / "cut.png"); }), HasSubstr("is no PNG"));
  EXPECT_THAT(MessageOf<InputError>([&] { ReadPng16(dir / "none.png"); }), HasSubstr("none.png"));
}

TEST(WritePng, RefusesWrongShapesAndPaths) {
  const TempDir dir;
  EXPECT_THROW(WritePng(dir / "a.png", {2, 2, 2, std::vector<uint8_t>(8)}), ShapeError);
  EXPECT_THROW(WritePng(dir / "a.png", {2, 2, 3, std::vector<uint8_t>(11)}), ShapeError);
  EXPECT_THROW(WritePng(dir / "a.png", {0, 2, 3, {}}), ShapeError);
  EXPECT_THROW(WritePng16(dir / "a.png", 2, 2, {1, 2, 3}), ShapeError);
  EXPECT_FALSE(std::filesystem::exists(dir / "a.png"));
  WriteText(dir / "file", "x");
  EXPECT_THROW(WritePng(dir / "file" / "a.png", SmoothImage(2, 2, 3)), RunError);
}

TEST(PngGrayBits, TellsGrayFromColor) {
  const TempDir dir;
  WritePng(dir / "gray.png", {2, 1, 1, {0, 255}});
  WritePng(dir / "color.png", {1, 1, 3, {1, 2, 3}});
  WritePng16(dir / "depth.png", 2, 1, {0, 1000});
  const auto bits = [&](const char* name) { return PngGrayBits(ReadHead(dir / name, kPngHeaderBytes)); };
  EXPECT_EQ(bits("gray.png"), 8);
  EXPECT_EQ(bits("color.png"), 0);
  EXPECT_EQ(bits("depth.png"), 16);
  EXPECT_EQ(PngGrayBits("no PNG"), 0);
}

}  // namespace
}  // namespace oraclegs
