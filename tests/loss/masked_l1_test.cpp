#include "oraclegs/loss/depth_losses.h"

#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/core/parallel.h"
#include "support/buffers.h"

namespace oraclegs {
namespace {

TEST(MaskedL1, DividesByAllPixels) {
  const Buffer<float> rendered = Buffer<float>::Full({4, 5}, 0.5f), target = Buffer<float>::Full({4, 5}, 0.25f);
  const Buffer<float> mask = Buffer<float>::Zeros({4, 5});
  Buffer<float> grad = Buffer<float>::Full({4, 5}, 9.f);
  mask[1 * 5 + 2] = 1;
  mask[3 * 5 + 4] = 1;
  EXPECT_NEAR(MaskedL1(rendered, target, mask, 0.5, &grad), 0.5 * 2 * 0.25 / 20, 1e-9);
  EXPECT_LT(MaxAbsError(grad, Wide(mask) * (0.5 / 20)), 1e-9);
}

TEST(MaskedL1, CountsAllPixelsWithoutAMask) {
  const Buffer<float> a = RandomUniform({13, 29}, 4), b = RandomUniform({13, 29}, 5);
  Buffer<float> grad = Buffer<float>::Empty(a.shape()), of_ones = Buffer<float>::Empty(a.shape());
  EXPECT_EQ(MaskedL1(a, b, {}, 0.3, &grad), MaskedL1(a, b, Buffer<float>::Full(a.shape(), 1.f), 0.3, &of_ones));
  EXPECT_TRUE(SameBytes(grad, of_ones));
}

TEST(MaskedL1, HasNoGradientAtEquality) {
  const Buffer<float> same = RandomUniform({6, 7}, 1);
  Buffer<float> grad = Buffer<float>::Full({6, 7}, 9.f);
  EXPECT_EQ(MaskedL1(same, same, Buffer<float>::Full({6, 7}, 1.f), 1, &grad), 0);
  EXPECT_EQ(MaxAbs(grad), 0);
}

TEST(MaskedL1, MatchesItsDefinitionAndCentralDifferences) {
  constexpr int64_t kHeight = 150, kWidth = 230;  // several blocks and a remainder
  const Buffer<float> a = RandomUniform({kHeight, kWidth}, 1), b = RandomUniform({kHeight, kWidth}, 2);
  const Buffer<float> mask = Above(RandomUniform({kHeight, kWidth}, 3), 0.4f);
  Buffer<float> grad = Buffer<float>::Empty({kHeight, kWidth});
  const double value = MaskedL1(a, b, mask, 0.7, &grad);
  const auto loss_at = [&](const Eigen::ArrayXd& x) { return 0.7 * ((x - Wide(b)).abs() * Wide(mask)).mean(); };
  EXPECT_NEAR(value, loss_at(Wide(a)), 1e-7);
  constexpr int64_t kPixel = 77 * kWidth + 99;
  Eigen::ArrayXd up = Wide(a), down = up;
  up[kPixel] += 1e-7;
  down[kPixel] -= 1e-7;
  EXPECT_NEAR(grad[kPixel], (loss_at(up) - loss_at(down)) / 2e-7, 1e-8);
  const Eigen::ArrayXd wanted = (Wide(a) - Wide(b)).sign() * Wide(mask) * (0.7 / (kHeight * kWidth));
  EXPECT_LT(MaxAbsError(grad, wanted), 1e-10);
}

TEST(MaskedL1, GivesTheSameBitsForAnyNumberOfThreads) {
  const Buffer<float> a = RandomUniform({300, 301}, 1), b = RandomUniform({300, 301}, 2);
  const Buffer<float> mask = Buffer<float>::Full({300, 301}, 1.f);
  SetNumThreads(1);
  const double one = MaskedL1(a, b, mask, 1, nullptr);
  SetNumThreads(3);
  EXPECT_EQ(MaskedL1(a, b, mask, 1, nullptr), one);
  SetNumThreads(0);
}

TEST(MaskedL1, SumsHugeImages) {
  const int64_t height = 2100, width = 2003;  // more pixels than the sums have room for in the usual blocks
  const Buffer<float> a = Buffer<float>::Full({height, width}, 0.75f), b = Buffer<float>::Full({height, width}, 0.5f);
  Buffer<float> grad = Buffer<float>::Zeros({height, width});
  EXPECT_NEAR(MaskedL1(a, b, Buffer<float>::Full({height, width}, 1.f), 2, &grad), 0.5, 1e-9);
  EXPECT_GT(Flat(grad).minCoeff(), 0);
}

TEST(MaskedL1, RefusesShapesThatDoNotFit) {
  const Buffer<float> a = RandomUniform({3, 4}, 1), empty = Buffer<float>::Empty({0, 4});
  Buffer<float> grad = Buffer<float>::Empty({4, 3});
  EXPECT_THROW(MaskedL1(a, RandomUniform({4, 3}, 2), a, 1, nullptr), ShapeError);
  EXPECT_THROW(MaskedL1(a, a, RandomUniform({3, 3}, 2), 1, nullptr), ShapeError);
  EXPECT_THROW(MaskedL1(a, a, a, 1, &grad), ShapeError);
  EXPECT_THROW(MaskedL1(empty, empty, empty, 1, nullptr), ShapeError);
}

}  // namespace
}  // namespace oraclegs
