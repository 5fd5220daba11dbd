#include "oraclegs/output/figures/sheet.h"

#include "oraclegs/core/files.h"
#include "oraclegs/image/read_image.h"
#include "support/errors.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

Image8 Plain(int width, int height, std::vector<uint8_t> color) {
  Image8 image{width, height, static_cast<int>(color.size()), {}};
  for (int i = 0; i < width * height; ++i) image.data.insert(image.data.end(), color.begin(), color.end());
  return image;
}

std::vector<int> PixelAt(const Image8& image, int x, int y) {
  std::vector<int> pixel;
  for (int c = 0; c < 3; ++c) {
    pixel.push_back(image.data[(static_cast<size_t>(y) * image.width + x) * static_cast<size_t>(image.channels) + c]);
  }
  return pixel;
}

class SheetTest : public testing::Test {
 protected:
  Sheet Two() const {
    return {
        {"left", "right"},
        {{{Plain(20, 10, {250, 10, 20}), "red"}, {Plain(20, 10, {77}), ""}}, {{Plain(10, 10, {0, 0, 255}), ""}, {}}},
        ColorMap::kPlasma,
        "confidence"};
  }
  TempDir dir;
};

TEST_F(SheetTest, HasEachImageInItsPlace) {
  const SheetFiles files = WriteSheet(Two(), dir / "folder/figure", 100);
  const Image8 image = ReadImage(files.png);
  EXPECT_EQ(image.width, 8 + 100 + 6 + 100 + 8);
  EXPECT_EQ(PixelAt(image, 8 + 50, 26 + 25), (std::vector<int>{250, 10, 20}));
  EXPECT_EQ(PixelAt(image, 114 + 50, 26 + 25), (std::vector<int>{77, 77, 77}));
  const int second = 26 + 50 + 18 + 6;  // a caption below the first row
  EXPECT_EQ(PixelAt(image, 8 + 50, second + 50), (std::vector<int>{0, 0, 255}));
  EXPECT_EQ(PixelAt(image, 114 + 50, second + 50), (std::vector<int>{255, 255, 255})) << "no image";
  const auto plasma = MapColor(ColorMap::kPlasma, 0.5f);
  const int bar = second + 100 + 6 + 5;
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(PixelAt(image, image.width / 2, bar)[static_cast<size_t>(c)], plasma[c], 4);
  EXPECT_EQ(ReadFile(files.pdf).substr(0, 5), "%PDF-");
}

TEST_F(SheetTest, ShowsText) {
  Sheet silent = Two();
  silent.heads = {"", ""};
  WriteSheet(Two(), dir / "a", 100);
  WriteSheet(silent, dir / "b", 100);
  const Image8 with = ReadImage(dir / "a.png"), without = ReadImage(dir / "b.png");
  ASSERT_EQ(with.data.size(), without.data.size());
  const auto head = static_cast<ptrdiff_t>(with.width) * 24 * with.channels;
  EXPECT_FALSE(std::equal(with.data.begin(), with.data.begin() + head, without.data.begin()));
  EXPECT_TRUE(std::equal(with.data.begin() + head, with.data.end(), without.data.begin() + head));
}

TEST_F(SheetTest, RefusesWhatDoesNotFit) {
  Sheet uneven = Two();
  uneven.rows[1].pop_back();
  EXPECT_THROW(WriteSheet(uneven, dir / "x", 100), ShapeError);
  EXPECT_THAT(MessageOf<UsageError>([&] { WriteSheet(Two(), dir / "x", 20000); }), testing::HasSubstr("narrower"));
  EXPECT_FALSE(std::filesystem::exists(dir / "x.png"));
}

}  // namespace
}  // namespace oraclegs
