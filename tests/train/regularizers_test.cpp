#include "oraclegs/train/regularizers.h"

#include <cmath>

#include "oraclegs/render/render.h"
#include "train/gaussian_fixtures.h"

namespace oraclegs {
namespace {

TEST(Regularizers, MatchTheirDerivativesOnEveryTarget) {
  constexpr double kOpacityReg = 0.3, kScaleReg = 0.7;
  for (const int64_t n : {1, 37, 3001}) {
    const Gaussians g = RandomGaussians(n, 8);
    const Eigen::ArrayXd opacity = 1 / (1 + (-Wide(g.opacity_logits)).exp()), scale = Wide(g.log_scales).exp();
    const double value = kOpacityReg * opacity.mean() + kScaleReg * scale.mean();
    const Eigen::ArrayXd by_logit = kOpacityReg * opacity * (1 - opacity) / static_cast<double>(n);
    const Eigen::ArrayXd by_log_scale = kScaleReg * scale / static_cast<double>(3 * n);
    const Gaussians start = RandomGaussians(n, 9);
    ForEachTarget([&](int64_t target) {
      Gaussians grads = start.Clone();
      EXPECT_NEAR(AddRegularizers(g, {kOpacityReg, kScaleReg}, &grads), value, 1e-6) << target;
      EXPECT_LT(MaxAbsError(Wide(grads.opacity_logits) - Wide(start.opacity_logits), by_logit), 2e-6);
      EXPECT_LT(MaxAbsError(Wide(grads.log_scales) - Wide(start.log_scales), by_log_scale), 2e-6);
      EXPECT_TRUE(Equal(grads.means, start.means) && Equal(grads.sh, start.sh));
      // From zero, the gradient is seen without the rounding of the sum.
      grads = Gaussians::Zeros(n);
      AddRegularizers(g, {kOpacityReg, kScaleReg}, &grads);
      EXPECT_LT(RelativeL2(grads.opacity_logits, by_logit), 1e-6) << target;
      EXPECT_LT(RelativeL2(grads.log_scales, by_log_scale), 1e-6) << target;
    });
  }
}

TEST(Regularizers, GiveTheSameBitsInBlocks) {
  Regularizers regularizers;
  for (const int64_t n : {7 * kGradBlock + 5, 2 * kGradBlock, int64_t{3}}) {
    const Gaussians g = RandomGaussians(n, 8);
    Gaussians whole = RandomGaussians(n, 9), cut = RandomGaussians(n, 9);
    const double value = AddRegularizers(g, {0.01, 0.02}, &whole);
    regularizers.Begin(g, {0.01, 0.02});
    const int64_t middle = std::min(n, 2 * kGradBlock);
    regularizers.AddTo(middle, n, cut.Rows().From(middle));
    regularizers.AddTo(0, middle, cut.Rows());
    EXPECT_EQ(regularizers.Value(), value);
    EXPECT_TRUE(SameBits(whole, cut));
  }
}

TEST(Regularizers, GiveTheSameBitsForAnyNumberOfThreads) {
  const Gaussians g = RandomGaussians(50001, 8);
  const auto run = [&](int threads) {
    const Threads scope(threads);
    Gaussians grads = Gaussians::Zeros(g.size());
    return AddRegularizers(g, {0.01, 0.01}, &grads);
  };
  const double one = run(1);
  EXPECT_EQ(one, run(2));
  EXPECT_EQ(one, run(5));
}

}  // namespace
}  // namespace oraclegs
