#include "oraclegs/loss/masked_l1.h"

#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/core/parallel.h"
#include "support/tensors.h"

namespace oraclegs {
namespace {

TEST(MaskedL1, MeanRunsOverAllPixelsNotOverTheMask) {
  const Buffer<float> rendered = Buffer<float>::Full({4, 5}, 0.5f), target = Buffer<float>::Full({4, 5}, 0.25f);
  Buffer<float> mask = Buffer<float>::Zeros({4, 5}), grad = Buffer<float>::Full({4, 5}, 9.f);
  mask[1][2] = 1;
  mask[3][4] = 1;
  EXPECT_NEAR(MaskedL1(rendered, target, mask, 0.5, &grad), 0.5 * 2 * 0.25 / 20, 1e-9);
  EXPECT_LT(MaxAbsError(grad, mask * (0.5 / 20)), 1e-9);
}

TEST(MaskedL1, WithoutAMaskAllPixelsCount) {
  torch::manual_seed(4);
  const Buffer<float> a = torch::rand({13, 29}), b = torch::rand({13, 29});
  Buffer<float> grad = Buffer<float>::Empty(a.shape()), of_ones = Buffer<float>::Empty(a.shape());
  EXPECT_EQ(MaskedL1(a, b, {}, 0.3, &grad), MaskedL1(a, b, torch::ones_like(a), 0.3, &of_ones));
  EXPECT_TRUE(torch::equal(grad, of_ones));
}

TEST(MaskedL1, EqualityHasNoGradient) {
  const Buffer<float> same = torch::rand({6, 7});
  Buffer<float> grad = Buffer<float>::Full({6, 7}, 9.f);
  EXPECT_EQ(MaskedL1(same, same, Buffer<float>::Full({6, 7}, 1.f), 1, &grad), 0);
  EXPECT_EQ(grad.abs().max().item<float>(), 0);
}

TEST(MaskedL1, MatchesTensorAlgebraAndCentralDifferences) {
  torch::manual_seed(1);
  const Buffer<float> a = torch::rand({150, 230}), b = torch::rand({150, 230});  // several blocks and a remainder
  const Buffer<float> mask = (torch::rand({150, 230}) > 0.4).to(torch::kFloat);
  Buffer<float> grad = torch::empty({150, 230});
  const double value = MaskedL1(a, b, mask, 0.7, &grad);
  const auto loss_at = [&](const Buffer<float>& x) {
    return 0.7 * ((x - b.to(torch::kDouble)).abs() * mask.to(torch::kDouble)).mean().item<double>();
  };
  const Buffer<float> wide = a.to(torch::kDouble);
  EXPECT_NEAR(value, loss_at(wide), 1e-7);
  Buffer<float> up = wide.Clone(), down = wide.Clone();
  up[77][99] += 1e-7;
  down[77][99] -= 1e-7;
  EXPECT_NEAR(grad[77][99].item<float>(), (loss_at(up) - loss_at(down)) / 2e-7, 1e-8);
  EXPECT_LT(MaxAbsError(grad, (a - b).sign() * mask * (0.7 / (150 * 230))), 1e-10);
}

TEST(MaskedL1, SameBitsForAnyNumberOfThreads) {
  const Buffer<float> a = torch::rand({300, 301}), b = torch::rand({300, 301}), mask = Buffer<float>::Full({300, 301}, 1.f);
  SetNumThreads(1);
  const double one = MaskedL1(a, b, mask, 1, nullptr);
  SetNumThreads(3);
  EXPECT_EQ(MaskedL1(a, b, mask, 1, nullptr), one);
  SetNumThreads(0);
}

TEST(MaskedL1, HugePicturesAreWholeToo) {
  const int64_t height = 2100, width = 2003;  // more pixels than the sums have room for in the usual stretches
  const Buffer<float> a = Buffer<float>::Full({height, width}, 0.75f), b = Buffer<float>::Full({height, width}, 0.5f);
  Buffer<float> grad = Buffer<float>::Zeros({height, width});
  EXPECT_NEAR(MaskedL1(a, b, Buffer<float>::Full({height, width}, 1.f), 2, &grad), 0.5, 1e-9);
  EXPECT_GT(grad.min().item<float>(), 0);
}

TEST(MaskedL1, RefusesTensorsThatDoNotFit) {
  const Buffer<float> a = torch::rand({3, 4});
  Buffer<float> grad = torch::empty({4, 3});
  EXPECT_THROW(MaskedL1(a, torch::rand({4, 3}), a, 1, nullptr), ShapeError);
  EXPECT_THROW(MaskedL1(a, a, torch::rand({3, 3}), 1, nullptr), ShapeError);
  EXPECT_THROW(MaskedL1(a, a, a, 1, &grad), ShapeError);
  EXPECT_THROW(MaskedL1(torch::empty({0, 4}), torch::empty({0, 4}), torch::empty({0, 4}), 1, nullptr), ShapeError);
}

}  // namespace
}  // namespace oraclegs
