#include "oraclegs/image/image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

TEST(ToFloat, RoundTripsEightBits) {
  Image8 all{16, 16, 1, {}};
  for (int i = 0; i < 256; ++i) all.data.push_back(static_cast<uint8_t>(i));
  const ImageF floats = ToFloat(all);
  EXPECT_EQ(floats.data.front(), 0.f);
  EXPECT_EQ(floats.data.back(), 1.f);
  EXPECT_EQ(ToImage8(floats).data, all.data);
}

TEST(ToImage8, ClampsAndRoundsHalfUp) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const ImageF image{6, 1, 1, {-1.f, 2.f, nan, 0.4999f / 255, 0.5f / 255, 254.5f / 255}};
  EXPECT_THAT(ToImage8(image).data, testing::ElementsAre(0, 255, 0, 0, 1, 255));
}

ImageF Noise(int width, int height, int channels) {
  ImageF image{width, height, channels, std::vector<float>(static_cast<size_t>(width * height * channels))};
  uint32_t state = 7;
  for (float& value : image.data) {
    state = state * 1664525u + 1013904223u;
    value = static_cast<float>(state >> 8) / static_cast<float>(1 << 24);
  }
  return image;
}

double Mean(const ImageF& image) {
  return std::accumulate(image.data.begin(), image.data.end(), 0.) / static_cast<double>(image.data.size());
}

TEST(ResizeArea, KeepsAConstant) {
  ImageF image = Noise(13, 11, 3);
  std::fill(image.data.begin(), image.data.end(), 0.37f);
  for (const auto& [width, height] : {std::pair{6, 5}, {13, 4}, {1, 1}, {12, 11}, {29, 30}, {5, 20}}) {
    const ImageF resized = ResizeArea(image, width, height);
    ASSERT_EQ(resized.data.size(), static_cast<size_t>(width * height * 3));
    for (const float value : resized.data) EXPECT_NEAR(value, 0.37f, 2e-7);
  }
}

TEST(ResizeArea, KeepsTheMeanWhenShrinking) {
  const ImageF image = Noise(37, 23, 3);
  for (const auto& [width, height] : {std::pair{18, 11}, {36, 22}, {37, 5}, {1, 1}, {10, 23}}) {
    EXPECT_NEAR(Mean(ResizeArea(image, width, height)), Mean(image), 1e-6) << width << " x " << height;
  }
}

TEST(ResizeArea, AveragesFourPixelsAtHalfSize) {
  const ImageF image = Noise(8, 6, 3);
  const ImageF half = ResizeArea(image, 4, 3);
  for (int y = 0; y < 3; ++y) {
    for (int i = 0; i < 12; ++i) {
      const int x = i / 3, c = i % 3;
      const auto at = [&](int dx, int dy) { return image.row(2 * y + dy)[3 * (2 * x + dx) + c]; };
      EXPECT_NEAR(half.row(y)[i], (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) / 4, 1e-7);
    }
  }
}

TEST(ResizeArea, WeighsByAreaAtFractionalFactors) {
  // 5 pixels to 2: each new one is 2.5 wide and owns half of the middle one.
  const ImageF row{5, 1, 1, {1, 2, 4, 8, 16}};
  const ImageF two = ResizeArea(row, 2, 1);
  EXPECT_FLOAT_EQ(two.data[0], (1 + 2 + 4 / 2.f) / 2.5f);
  EXPECT_FLOAT_EQ(two.data[1], (4 / 2.f + 8 + 16) / 2.5f);
  const ImageF column{1, 5, 1, {1, 2, 4, 8, 16}};
  EXPECT_EQ(ResizeArea(column, 1, 2).data, two.data);
  const ImageF three = ResizeArea({4, 1, 1, {1, 2, 4, 8}}, 3, 1);
  EXPECT_FLOAT_EQ(three.data[0], (1 + 2 / 3.f) * 0.75f);
  EXPECT_FLOAT_EQ(three.data[1], (2 * 2 / 3.f + 4 * 2 / 3.f) * 0.75f);
  EXPECT_FLOAT_EQ(three.data[2], (4 / 3.f + 8) * 0.75f);
}

TEST(ResizeArea, InterpolatesWhenEnlarging) {
  const ImageF row{2, 1, 1, {0, 1}};
  EXPECT_THAT(ResizeArea(row, 4, 1).data, testing::ElementsAre(0.f, 0.25f, 0.75f, 1.f));
}

TEST(ResizeArea, FollowsTheScaledIntrinsics) {
  // The value at u is u; after shrinking, the pixel center u' sees u = u' * old / new.
  ImageF ramp{90, 2, 1, std::vector<float>(180)};
  for (int i = 0; i < 180; ++i) ramp.data[static_cast<size_t>(i)] = static_cast<float>(i % 90) + 0.5f;
  const ImageF third = ResizeArea(ramp, 30, 1);
  for (int x = 0; x < 30; ++x) EXPECT_NEAR(third.data[static_cast<size_t>(x)], (x + 0.5) * 3, 1e-5);
  const ImageF odd = ResizeArea(ramp, 40, 1);  // steps of the old pixels show, but never a shift
  double shift = 0;
  for (int x = 0; x < 40; ++x) {
    const double off = odd.data[static_cast<size_t>(x)] - (x + 0.5) * 90 / 40;
    EXPECT_LT(std::abs(off), 0.05);
    shift += off;
  }
  EXPECT_NEAR(shift / 40, 0, 1e-5);
}

TEST(ResizeArea, CopiesAtTheSameSize) {
  const ImageF image = Noise(7, 5, 4);
  EXPECT_EQ(ResizeArea(image, 7, 5).data, image.data);
}

TEST(ResizeArea, GivesTheSameBitsForAnyThreadCount) {
  const ImageF image = Noise(101, 203, 3);
  SetNumThreads(1);
  const ImageF one = ResizeArea(image, 33, 77);
  SetNumThreads(4);
  EXPECT_EQ(ResizeArea(image, 33, 77).data, one.data);
  SetNumThreads(0);
}

TEST(ResizeArea, RefusesAnEmptyImage) {
  EXPECT_THROW(ResizeArea(Noise(4, 4, 1), 0, 2), ShapeError);
  EXPECT_THROW(ResizeArea({}, 2, 2), ShapeError);
}

TEST(CheckImageSize, RefusesMoreThanItIsAllowed) {
  const auto message = [](int64_t width, int64_t height) {
    return MessageOf<InputError>([&] { CheckImageSize(width, height, ~uint64_t{0}, "f.png"); });
  };
  EXPECT_EQ(message(16000, 16000), "");
  EXPECT_NE(message(17000, 16000).find("at most 268 million"), std::string::npos);
  SetMaxMegapixels(1);
  EXPECT_EQ(message(1000, 1000), "");
  EXPECT_NE(message(1001, 1000).find("--max-megapixels"), std::string::npos);
  SetMaxMegapixels(kUsualMaxMegapixels);
}

TEST(ResizeLikePillow, MatchesPillow) {
  // Image.fromarray(np.array([[0, 40, 200, 255, 10]], np.uint8)).resize((3, 1), Image.BICUBIC)
  const Image8 row{5, 1, 1, {0, 40, 200, 255, 10}};
  EXPECT_THAT(ResizeLikePillow(row, 3, 1).data, testing::ElementsAre(10, 189, 118));
  EXPECT_THAT(ResizeLikePillow(row, 8, 1).data, testing::ElementsAre(0, 8, 47, 154, 235, 255, 109, 0));
  EXPECT_EQ(ResizeLikePillow(row, 5, 1).data, row.data);
}

TEST(ResizeLikePillow, RefusesAnEmptyImage) {
  EXPECT_THROW(ResizeLikePillow({4, 4, 1, std::vector<uint8_t>(16)}, 0, 3), ShapeError);
  EXPECT_THROW(ResizeLikePillow({}, 2, 3), ShapeError);
}

}  // namespace
}  // namespace oraclegs
