#include "oraclegs/capture/sharpness.h"

#include "image/jpeg_files.h"

namespace oraclegs {
namespace {

TEST(Sharpness, FallsWithBlur) {
  Image8 noise{64, 48, 1, {}};
  uint32_t state = 1;
  for (int i = 0; i < 64 * 48; ++i)
    noise.data.push_back(static_cast<uint8_t>((state = state * 1664525u + 1013904223u) >> 24));
  const Image8 blurred = ToImage8(ResizeArea(ResizeArea(ToFloat(noise), 16, 12), 64, 48));
  EXPECT_GT(Sharpness(noise), 10 * Sharpness(blurred));
  EXPECT_EQ(Sharpness({64, 48, 1, std::vector<uint8_t>(64 * 48, 7)}), 0);
  EXPECT_EQ(Sharpness({2, 2, 1, {1, 2, 3, 4}}), 0);
}

}  // namespace
}  // namespace oraclegs
