// Parity with the reference numbers for every instruction set of this machine, and the same bits for any number of
// threads.

#include "oraclegs/loss/photometric_kernel.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "oraclegs/core/parallel.h"
#include "oraclegs/loss/photometric.h"
#include "support/tensors.h"

namespace oraclegs {
namespace {

/// [3,H,W] as stored to [H,W,3] as used.
Buffer<float> Interleaved(const Buffer<float>& planar) { return planar.permute({1, 2, 0}); }

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
  void SetUp() override {
    hwy::SetSupportedTargetsForTest(GetParam());
    const SafetensorsFile file = OpenGolden("ssim");
    render_ = Interleaved(GoldenFloat(file, "render"));
    target_ = Interleaved(GoldenFloat(file, "target"));
    confidence_ = GoldenFloat(file, "confidence");
  }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }

  /// Runs the loss and holds gradient and value to the file's.
  PhotometricValue Run(const PhotometricWeights& weights, bool weighted, const std::string& gradient) const {
    Buffer<float> grad = Buffer<float>::Empty(render_.shape());
    const PhotometricValue value =
        PhotometricLoss()(render_, target_, weighted ? confidence_ : Buffer<float>(), weights, &grad);
    const Buffer<float> expected = Interleaved(GoldenTensor(OpenGolden("ssim"), gradient));
    EXPECT_LT(RelativeL2(grad, expected), 5e-5) << gradient;
    return value;
  }

  double Golden(const std::string& name) const { return GoldenTensor(OpenGolden("ssim"), name).item<double>(); }

  Buffer<float> render_, target_, confidence_;
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
  const Buffer<float> expected = Interleaved(GoldenTensor(OpenGolden("ssim"), "ssim_map"));
  EXPECT_LT(MaxAbsError(SsimMap(render_, target_), expected), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Targets, PhotometricGolden, testing::ValuesIn(MachineTargets()),
                         [](const auto& info) { return std::string(hwy::TargetName(info.param)); });

TEST(PhotometricThreads, SameBitsForAnyNumber) {
  torch::manual_seed(3);
  const Buffer<float> render = torch::rand({203, 307, 3}), target = torch::rand({203, 307, 3});
  const Buffer<float> confidence = torch::rand({203, 307});
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
    EXPECT_TRUE(torch::equal(grad, first)) << threads;
    EXPECT_TRUE(torch::equal(SsimMap(render, target), map)) << threads;
  }
  SetNumThreads(0);
}

TEST(PhotometricTile, WritesOnlyItsOwnPixels) {
  const Buffer<float> render = torch::rand({40, 40, 3}), target = torch::rand({40, 40, 3});
  Buffer<float> grad = Buffer<float>::Full({40, 40, 3}, -5.f), whole = torch::empty({40, 40, 3});
  photometric::Picture picture;
  picture.width = picture.height = 40;
  picture.render = render.data();
  picture.target = target.data();
  picture.grad = grad.data();
  picture.l1_scale = static_cast<float>(static_cast<double>(0.8f) / (3 * 40 * 40));
  picture.dssim_scale = static_cast<float>(static_cast<double>(0.2f) / (3 * 40 * 40));
  const auto scratch = std::make_unique<photometric::Scratch>();
  photometric::RunTile(picture, {7, 9, 26, 22}, scratch.get());
  PhotometricLoss()(render, target, {}, {}, &whole);
  const auto inside = [](const Buffer<float>& t) { return t.slice(0, 9, 22).slice(1, 7, 26); };
  EXPECT_LT(MaxAbsError(inside(grad), inside(whole)), 1e-8);
  EXPECT_EQ((grad == -5).sum().item<int64_t>(), 3 * (40 * 40 - 13 * 19));
}

}  // namespace
}  // namespace oraclegs
