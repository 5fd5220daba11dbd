#include "oraclegs/formats/codebook.h"

#include <algorithm>
#include <set>

#include "formats/splats.h"

namespace oraclegs {
namespace {

TEST(Codebook, LiesNearAllValues) {
  const Buffer<float> values = RandomNormal({20000}, 4);
  const std::vector<float> codebook = MakeCodebook({values.span().begin(), values.span().end()});
  ASSERT_EQ(codebook.size(), 256u);
  EXPECT_TRUE(std::is_sorted(codebook.begin(), codebook.end()));
  double squares = 0;
  for (const float v : values.span()) {
    const float error = v - codebook[NearestEntry(codebook, v)];
    squares += error * error;
  }
  EXPECT_LT(std::sqrt(squares / 20000), 0.008);  // equal steps from the least to the largest leave 0.009
}

TEST(Codebook, HoldsFewValuesExactly) {
  EXPECT_EQ(MakeCodebook({})[0], 0);
  EXPECT_EQ(MakeCodebook({3, 3, 3})[255], 3);
  const std::vector<float> codebook = MakeCodebook({-1, 5, 7});
  for (const float v : {-1.f, 5.f, 7.f}) EXPECT_NEAR(codebook[NearestEntry(codebook, v)], v, 1e-5f);
}

TEST(NearestEntry, RoundsToEitherSide) {
  const std::vector<float> codebook = {0, 1, 3};
  EXPECT_EQ(NearestEntry(codebook, -9), 0);
  EXPECT_EQ(NearestEntry(codebook, 1.9f), 1);
  EXPECT_EQ(NearestEntry(codebook, 2.1f), 2);
  EXPECT_EQ(NearestEntry(codebook, 9), 2);
}

TEST(Palette, HoldsFewDifferentVectorsExactly) {
  const Buffer<float> vectors = Buffer<float>::Zeros({400, 5});
  for (int64_t i = 0; i < 400; ++i) vectors[5 * i + i % 4] = 1 + static_cast<float>(i % 4);
  const Palette palette = MakePalette(vectors, std::vector<float>(400, 1), 64);
  EXPECT_LE(palette.colors.size(0), 64);
  for (int64_t i = 0; i < 400; ++i) {
    EXPECT_EQ(palette.colors[5 * palette.labels[i] + i % 4], 1 + static_cast<float>(i % 4));
  }
}

TEST(Palette, GrowsBetterWithItsSize) {
  const Buffer<float> vectors = RandomNormal({3000, 3}, 5);
  const auto error = [&](int size) {
    const Palette palette = MakePalette(vectors, std::vector<float>(3000, 1), size);
    EXPECT_LE(palette.colors.size(0), size);
    double squares = 0;
    for (int64_t i = 0; i < 3000; ++i) {
      squares += (Table(vectors).row(i) - Table(palette.colors).row(palette.labels[i])).square().sum();
    }
    return std::sqrt(squares / 9000);
  };
  EXPECT_NEAR(error(1), 1, 0.05);
  EXPECT_LT(error(64), 0.4);
  EXPECT_LT(error(1024), 0.15);
}

TEST(Palette, MeetsHeavyRowsBetter) {
  const Buffer<float> vectors = RandomNormal({2000, 4}, 6);
  std::vector<float> weights(2000, 0.001f);
  for (size_t i = 0; i < 2000; i += 2) weights[i] = 1;
  const Palette palette = MakePalette(vectors, weights, 16);
  double heavy = 0, light = 0;
  for (int64_t i = 0; i < 2000; ++i) {
    (i % 2 == 0 ? heavy : light) +=
        (Table(vectors).row(i) - Table(palette.colors).row(palette.labels[i])).square().sum();
  }
  EXPECT_LT(heavy, light);
}

}  // namespace
}  // namespace oraclegs
