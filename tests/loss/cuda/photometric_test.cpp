#include "oraclegs/loss/cuda/photometric.h"

#include "oraclegs/loss/objective.h"
#include "support/device_buffers.h"
#include "support/golden.h"
#include "support/buffers.h"

namespace oraclegs::cuda {
namespace {

struct Value {
  double l1 = 0, dssim = 0;  ///< means
  Buffer<float> grad;
};

DeviceImage ImageOf(const Buffer<float>& t) {
  if (!t.defined()) return {};
  return {t.data_ptr(), t.scalar_type() == torch::kByte};
}

Value RunOnDevice(const Buffer<float>& render, const Buffer<float>& target, const Buffer<float>& confidence,
                  const PhotometricWeights& weights, MaskMeaning meaning = MaskMeaning::kConfidence) {
  const Buffer<float> x = OnTestDevice(render), y = OnTestDevice(target), u = OnTestDevice(confidence);
  PhotometricInput in;
  in.height = static_cast<int>(render.size(0));
  in.width = static_cast<int>(render.size(1));
  in.render = x.data();
  in.target = ImageOf(y);
  in.confidence = ImageOf(u);
  in.meaning = meaning;
  const double entries = 3.0 * in.width * in.height;
  in.l1_scale = static_cast<float>(weights.l1 / entries);
  in.dssim_scale = static_cast<float>(weights.dssim / entries);
  DeviceArray<PhotometricSums> sums("a test");
  DeviceArray<float> slopes("a test");
  sums.ReserveExactly(PhotometricTiles(in.width, in.height));
  slopes.ReserveExactly(PhotometricSlopes(in.width, in.height));
  const Buffer<float> grad = torch::full_like(x, 7.f);
  RunPhotometric(in, {sums.data(), slopes.data(), grad.data()}, nullptr);
  Value value;
  for (const PhotometricSums& tile : ToHost(sums, PhotometricTiles(in.width, in.height))) {
    value.l1 += tile.l1 / entries;
    value.dssim += tile.dssim / entries;
  }
  value.grad = OnHost(grad);
  return value;
}

Buffer<float> RandomTarget(int64_t height, int64_t width) {
  torch::manual_seed(7 * height + width);
  return torch::rand({height, width, 3});
}

class CudaPhotometric : public OnDevice<testing::TestWithParam<std::pair<int64_t, int64_t>>> {
 protected:
  void SetUp() override {
    OnDevice::SetUp();
    const auto [height, width] = GetParam();
    target = RandomTarget(height, width);
    render = (target + 0.3 * torch::randn_like(target));
    confidence = torch::rand({height, width});
  }

  void ExpectAsOnTheCpu(const Buffer<float>& u) {
    const PhotometricWeights weights{0.7f, 0.3f};
    Buffer<float> grad = Buffer<float>::Empty(render.shape());
    const PhotometricValue expected = PhotometricLoss()(render, target, u, weights, &grad);
    const Value value = RunOnDevice(render, target, u, weights);
    EXPECT_NEAR(value.l1, expected.l1, 1e-7);
    EXPECT_NEAR(value.dssim, expected.dssim, 1e-6);
    EXPECT_LE(MaxAbsError(value.grad, grad), 1e-5 * grad.abs().max().item<double>());
  }

  Buffer<float> render, target, confidence;
};

TEST_P(CudaPhotometric, IsTheCpusWithoutConfidence) { ExpectAsOnTheCpu({}); }

TEST_P(CudaPhotometric, IsTheCpusWithConfidence) {
  confidence.narrow(1, 0, (confidence.size(1) + 1) / 2).SetZero();
  ExpectAsOnTheCpu(confidence);
}

TEST_P(CudaPhotometric, NothingCountsWithoutAnyConfidence) {
  const Value value = RunOnDevice(render, target, torch::zeros_like(confidence), {});
  EXPECT_EQ(value.l1, 0);
  EXPECT_EQ(value.dssim, 0);
  EXPECT_EQ(value.grad.abs().max().item<float>(), 0);
}

TEST_P(CudaPhotometric, AMaskHidesTheRenderAsOnTheCpu) {
  const Buffer<float> mask = (confidence > 0.4).to(torch::kFloat);
  Buffer<float> grad = Buffer<float>::Empty(render.shape());
  const double expected = Objective(ObjectiveWeights()).Photograph(render, target, mask, &grad);
  // What stands where the mask is zero has no say, whatever it is.
  const Buffer<float> noisy = torch::where(mask.unsqueeze(2) > 0, render, torch::full_like(render, 50.f));
  const Value value = RunOnDevice(noisy, target, mask, {0.8f, 0.2f}, MaskMeaning::kMask);
  EXPECT_NEAR(0.8 * value.l1 + 0.2 * value.dssim, expected, 1e-6);
  EXPECT_LE(MaxAbsError(value.grad, grad), 1e-5 * grad.abs().max().item<double>() + 1e-12);
}

TEST_P(CudaPhotometric, BytesAreTheSameToTheBit) {
  const Buffer<float> bytes = (target * 255 + 0.5f).to(torch::kByte), floats = bytes.to(torch::kFloat) / 255;
  const Buffer<float> mask_bytes = (confidence * 255).to(torch::kByte), mask_floats = mask_bytes.to(torch::kFloat) / 255;
  const Value packed = RunOnDevice(render, bytes, mask_bytes, {}), plain = RunOnDevice(render, floats, mask_floats, {});
  EXPECT_EQ(packed.l1, plain.l1);
  EXPECT_EQ(packed.dssim, plain.dssim);
  EXPECT_TRUE(torch::equal(packed.grad, plain.grad));
}

INSTANTIATE_TEST_SUITE_P(Sizes, CudaPhotometric,
                         testing::Values(std::pair<int64_t, int64_t>{1, 1}, std::pair<int64_t, int64_t>{16, 32},
                                         std::pair<int64_t, int64_t>{17, 5}, std::pair<int64_t, int64_t>{5, 71},
                                         std::pair<int64_t, int64_t>{37, 53}));

class CudaPhotometricGolden : public CudaTest {};

TEST_F(CudaPhotometricGolden, MatchesTheReference) {
  const SafetensorsFile golden = OpenGolden("ssim");
  const auto image = [&](const char* name) { return GoldenFloat(golden, name).permute({1, 2, 0}); };
  const Buffer<float> render = image("render"), target = image("target"), confidence = GoldenFloat(golden, "confidence");
  const auto number = [&](const char* name) { return golden.Values<double>(name).at(0); };
  const Value photograph = RunOnDevice(render, target, {}, {0.8f, 0.2f});
  EXPECT_NEAR(photograph.l1, number("l1"), 2e-6);
  EXPECT_NEAR(1 - photograph.dssim, number("ssim"), 2e-6);
  const Buffer<float> grad = GoldenTensor(golden, "grad_loss_photograph").permute({1, 2, 0});
  EXPECT_LE(RelativeL2(photograph.grad, grad), 5e-5);
  const Value proposal = RunOnDevice(render, target, confidence, {0.4f, 0.3f});
  EXPECT_NEAR(proposal.dssim, number("dssim_weighted"), 2e-6);
  EXPECT_NEAR(0.4 * proposal.l1 + 0.3 * proposal.dssim, number("loss_proposal"), 2e-6);
  EXPECT_LE(RelativeL2(proposal.grad, GoldenTensor(golden, "grad_loss_proposal").permute({1, 2, 0})), 5e-5);
}

}  // namespace
}  // namespace oraclegs::cuda
