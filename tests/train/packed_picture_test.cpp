#include "oraclegs/train/packed_picture.h"

#include <gtest/gtest.h>

#include <cmath>

namespace oraclegs {
namespace {

TEST(PackedPictureTest, BytesComeBackToTheBit) {
  const Buffer<float> bytes = torch::arange(0, 256).to(torch::kByte).view({16, 16, 1});
  Buffer<float> floats = torch::empty({16, 16, 1});
  for (int i = 0; i < 256; ++i) floats.data()[i] = static_cast<float>(i) / 255;  // as files are read
  const Buffer<float> packed = Packed(floats);
  EXPECT_EQ(packed.scalar_type(), torch::kByte);
  EXPECT_TRUE(torch::equal(packed, bytes));
  EXPECT_TRUE(torch::equal(packed.to(torch::kFloat).div_(255), floats));
}

TEST(PackedPictureTest, WhatBytesCannotHoldStaysAsItIs) {
  for (const float odd : {0.5f, -1 / 255.f, 256 / 255.f, std::nanf(""), std::nextafter(1.f, 0.f)}) {
    const Buffer<float> picture = Buffer<float>::Zeros({5, 7});
    picture[4][6] = odd;
    EXPECT_TRUE(Packed(picture).is_same(picture)) << odd;
  }
  EXPECT_FALSE(Packed({}).defined());
}

}  // namespace
}  // namespace oraclegs
