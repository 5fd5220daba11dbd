#include "oraclegs/validate/tamper.h"

#include <gtest/gtest.h>

#include <numeric>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

ImageF Gradient(int width, int height) {
  ImageF image{width, height, 3, {}};
  for (int i = 0; i < width * height; ++i) {
    for (int c = 0; c < 3; ++c) image.data.push_back(static_cast<float>((i * (c + 3)) % 97) / 96);
  }
  return image;
}

double MeanOf(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Tampered Tampering(double share, uint64_t counter = 0) {
  Rng rng(3, RandomStream::kTampering, counter);
  return Tamper(Gradient(80, 60), Gradient(31, 17), share, &rng);
}

TEST(Tamper, ReplacesAShareAndLeavesTheRest) {
  const ImageF image = Gradient(80, 60);
  for (const double share : {0.1, 0.3, 0.6}) {
    const Tampered tampered = Tampering(share);
    EXPECT_GE(MeanOf(tampered.share), share);
    EXPECT_LT(MeanOf(tampered.share), share + 0.2);
    size_t changed = 0, replaced = 0;
    for (size_t i = 0; i < tampered.share.size(); ++i) {
      bool same = true;
      for (size_t c = 3 * i; c < 3 * i + 3; ++c) {
        EXPECT_GE(tampered.rgb.data[c], 0.f);
        EXPECT_LE(tampered.rgb.data[c], 1.f);
        same = same && tampered.rgb.data[c] == image.data[c];
      }
      if (tampered.share[i] == 0) {
        EXPECT_TRUE(same) << i;
      }
      replaced += tampered.share[i] > 0.5f ? 1 : 0;
      changed += tampered.share[i] > 0.5f && !same ? 1 : 0;
    }
    EXPECT_GT(changed, replaced * 9 / 10);
  }
}

TEST(Tamper, IsAFunctionOfSeedAndCounter) {
  EXPECT_EQ(Tampering(0.3).rgb.data, Tampering(0.3).rgb.data);
  EXPECT_NE(Tampering(0.3).rgb.data, Tampering(0.3, 1000).rgb.data);
}

TEST(Tamper, NeedsNoOtherImage) {
  Rng rng(3, RandomStream::kTampering);
  EXPECT_GE(MeanOf(Tamper(Gradient(80, 60), {}, 0.3, &rng).share), 0.3);
}

TEST(Tamper, LeavesAllWhereNothingIsAskedFor) { EXPECT_EQ(Tampering(0).rgb.data, Gradient(80, 60).data); }

TEST(Tamper, RefusesAnEmptyImage) {
  Rng rng(3, RandomStream::kTampering);
  EXPECT_THROW(Tamper({}, {}, 0.3, &rng), ShapeError);
}

TEST(UpsideDown, TurnsTheImageTwiceToItself) {
  const ImageF image = Gradient(7, 5), turned = UpsideDown(image);
  EXPECT_EQ(turned.row(4)[3 * 6 + 1], image.row(0)[1]);
  EXPECT_EQ(UpsideDown(turned).data, image.data);
}

TEST(Zoomed, ShowsTheMiddle) {
  const ImageF image = Gradient(8, 8), zoomed = Zoomed(image, 2);
  EXPECT_EQ(zoomed.row(0)[0], image.row(2)[3 * 2]);
  EXPECT_EQ(zoomed.row(7)[3 * 7 + 2], image.row(5)[3 * 5 + 2]);
}

}  // namespace
}  // namespace oraclegs
