// Parity with the reference numbers for every instruction set of this machine, and the same bits for any number of
// threads.

#include "oraclegs/loss/photometric_kernel.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "oraclegs/core/parallel.h"
#include "oraclegs/loss/photometric.h"
#include "support/buffers.h"

namespace oraclegs {
namespace {

std::vector<int64_t> MachineTargets() {
  std::vector<int64_t> targets;
  for (uint64_t left = static_cast<uint64_t>(hwy::SupportedTargets()); left != 0; left &= left - 1) {
    const int64_t one = static_cast<int64_t>(left & (~left + 1));
    if ((one & HWY_TARGETS) != 0) targets.push_back(one);
  }
  return targets;
}

class PhotometricGolden : public testing::TestWithParam<int64_t> {
 protected:
  void SetUp() override { hwy::SetSupportedTargetsForTest(GetParam()); }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }

  /// Runs the loss and compares gradient and value with the file's.
  PhotometricValue Run(const PhotometricWeights& weights, bool weighted, const std::string& gradient) const {
    Buffer<float> grad = Buffer<float>::Empty(render.shape());
    const PhotometricValue value =
        PhotometricLoss()(render, target, weighted ? confidence : Buffer<float>(), weights, &grad);
    EXPECT_LT(RelativeL2(grad, Interleaved(GoldenDouble(file, gradient))), 5e-5) << gradient;
    return value;
  }

  double Golden(const std::string& name) const { return GoldenDouble(file, name)[0]; }

  const SafetensorsFile file = OpenGolden("ssim");  // its images are [3,H,W]
  const Buffer<float> render = Interleaved(GoldenFloat(file, "render"));
  const Buffer<float> target = Interleaved(GoldenFloat(file, "target"));
  const Buffer<float> confidence = GoldenFloat(file, "confidence");
};

TEST_P(PhotometricGolden, ValuesAndGradients) {
  EXPECT_NEAR(Run({1, 0}, false, "grad_l1").loss, Golden("l1"), 2e-6);
  EXPECT_NEAR(Run({1, 0}, true, "grad_l1_weighted").loss, Golden("l1_weighted"), 2e-6);
  EXPECT_NEAR(Run({0, 1}, true, "grad_dssim_weighted").loss, Golden("dssim_weighted"), 2e-6);
  EXPECT_NEAR(1 - Run({0, -1}, false, "grad_ssim").dssim, Golden("ssim"), 2e-6);
  EXPECT_NEAR(Run({0.8f, 0.2f}, false, "grad_loss_photograph").loss, Golden("loss_photograph"), 2e-6);
  EXPECT_NEAR(Run({0.4f, 0.3f}, true, "grad_loss_proposal").loss, Golden("loss_proposal"), 2e-6);
}

TEST_P(PhotometricGolden, Map) {
  EXPECT_LT(MaxAbsError(SsimMap(render, target), Interleaved(GoldenDouble(file, "ssim_map"))), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Targets, PhotometricGolden, testing::ValuesIn(MachineTargets()),
                         [](const auto& info) { return std::string(hwy::TargetName(info.param)); });

TEST(PhotometricThreads, GiveTheSameBits) {
  const Buffer<float> render = RandomUniform({203, 307, 3}, 3), target = RandomUniform({203, 307, 3}, 4);
  const Buffer<float> confidence = RandomUniform({203, 307}, 5);
  double loss = 0;
  Buffer<float> first, map;
  for (const int threads : {1, 2, 3}) {
    SetNumThreads(threads);
    Buffer<float> grad = Buffer<float>::Empty(render.shape());
    const PhotometricValue value = PhotometricLoss()(render, target, confidence, {}, &grad);
    if (threads == 1) {
      first = grad;
      loss = value.loss;
      map = SsimMap(render, target);
    }
    EXPECT_EQ(value.loss, loss) << threads;
    EXPECT_TRUE(SameBytes(grad, first)) << threads;
    EXPECT_TRUE(SameBytes(SsimMap(render, target), map)) << threads;
  }
  SetNumThreads(0);
}

TEST(PhotometricTile, WritesOnlyItsOwnPixels) {
  const Buffer<float> render = RandomUniform({40, 40, 3}, 1), target = RandomUniform({40, 40, 3}, 2);
  Buffer<float> grad = Buffer<float>::Full({40, 40, 3}, -5.f), whole = Buffer<float>::Empty({40, 40, 3});
  photometric::Images images;
  images.width = images.height = 40;
  images.render = render.data();
  images.target = target.data();
  images.grad = grad.data();
  images.l1_scale = static_cast<float>(static_cast<double>(0.8f) / (3 * 40 * 40));
  images.dssim_scale = static_cast<float>(static_cast<double>(0.2f) / (3 * 40 * 40));
  const auto scratch = std::make_unique<photometric::Scratch>();
  photometric::RunTile(images, {7, 9, 26, 22}, scratch.get());
  PhotometricLoss()(render, target, {}, {}, &whole);
  const auto inside = [](const Buffer<float>& t) { return Table(t).block(9, 3 * 7, 13, 3 * 19); };
  EXPECT_LT((inside(grad) - inside(whole)).abs().maxCoeff(), 1e-8f);
  EXPECT_EQ((Flat(grad) == -5).count(), 3 * (40 * 40 - 13 * 19));
}

}  // namespace
}  // namespace oraclegs
