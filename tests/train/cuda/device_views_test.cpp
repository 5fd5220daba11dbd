#include "oraclegs/train/cuda/device_views.h"

#include <gtest/gtest.h>

#include <cmath>

namespace oraclegs::cuda {
namespace {

TEST(PackedImage, KeepsEveryBitOfByteValues) {
  const Buffer<float> floats = Buffer<float>::Empty({16, 16, 1});
  for (int i = 0; i < 256; ++i) floats[i] = static_cast<float>(i) / 255;  // as files are read
  const PackedImage packed = Packed(floats);
  EXPECT_FALSE(packed.floats.defined());
  ASSERT_EQ(packed.bytes.shape(), floats.shape());
  EXPECT_EQ(packed.size_in_bytes(), 256);
  for (int i = 0; i < 256; ++i) {
    EXPECT_EQ(packed.bytes[i], i);
    EXPECT_EQ(static_cast<float>(packed.bytes[i]) / 255, floats[i]);
  }
}

TEST(PackedImage, LeavesOtherValuesAsFloats) {
  for (const float odd : {0.5f, -1 / 255.f, 256 / 255.f, std::nanf(""), std::nextafter(1.f, 0.f)}) {
    const Buffer<float> image = Buffer<float>::Zeros({5, 7});
    image[34] = odd;
    const PackedImage packed = Packed(image);
    EXPECT_EQ(packed.floats.data(), image.data()) << odd;
    EXPECT_FALSE(packed.bytes.defined());
  }
  EXPECT_FALSE(Packed({}).defined());
}

}  // namespace
}  // namespace oraclegs::cuda
