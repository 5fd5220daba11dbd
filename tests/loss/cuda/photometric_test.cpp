#include "oraclegs/loss/cuda/photometric.h"

#include <type_traits>

#include "oraclegs/loss/photometric.h"
#include "support/buffers.h"
#include "support/device_buffers.h"
#include "support/golden.h"

namespace oraclegs::cuda {
namespace {

struct Value {
  double l1 = 0, dssim = 0;  ///< means
  Buffer<float> grad;
};

template <class T>
DeviceImage ImageOf(const Buffer<T>& image) {
  return {image.data(), std::is_same_v<T, uint8_t>};
}

/// Target and confidence are floats or bytes.
template <class Target = float, class Confidence = float>
Value RunOnDevice(const Buffer<float>& render, const Buffer<Target>& target, const Buffer<Confidence>& confidence,
                  const PhotometricWeights& weights, MaskMeaning meaning = MaskMeaning::kConfidence,
                  int channels_at_once = 3) {
  const Buffer<float> x = OnTestDevice(render);
  const Buffer<Target> y = OnTestDevice(target);
  const Buffer<Confidence> u = OnTestDevice(confidence);
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
  DeviceArray<float> derivatives("a test");
  sums.ReserveExactly(PhotometricTiles(in.width, in.height));
  derivatives.ReserveExactly(PhotometricDerivatives(int64_t{in.width} * in.height, channels_at_once));
  const Buffer<float> grad = OnTestDevice(Buffer<float>::Full(render.shape(), 7.f));
  RunPhotometric(in, {sums.data(), derivatives.data(), channels_at_once, grad.data()}, nullptr);
  Value value;
  for (const PhotometricSums& tile : ToHost(sums, PhotometricTiles(in.width, in.height))) {
    value.l1 += tile.l1 / entries;
    value.dssim += tile.dssim / entries;
  }
  value.grad = OnHost(grad);
  return value;
}

/// Values in [0, 1] as bytes, rounded down.
Buffer<uint8_t> Bytes(const Shape& shape, const Eigen::ArrayXf& values) {
  const Buffer<uint8_t> bytes = Buffer<uint8_t>::Empty(shape);
  Flat(bytes) = (values * 255).cast<uint8_t>();
  return bytes;
}
Buffer<float> Floats(const Buffer<uint8_t>& bytes) { return ToBuffer(bytes.shape(), Flat(bytes).cast<float>() / 255); }

TEST(DeviceImageTest, BytesAreWhatAReaderOfFilesGives) {
  for (int value = 0; value < 256; ++value) {
    const auto byte = static_cast<uint8_t>(value);
    EXPECT_EQ((DeviceImage{&byte, true}.At(0)), static_cast<float>(value) / 255) << value;
  }
}

class CudaPhotometric : public OnDevice<testing::TestWithParam<std::pair<int64_t, int64_t>>> {
 protected:
  void SetUp() override {
    OnDevice::SetUp();
    const auto [height, width] = GetParam();
    const Shape shape{height, width, 3};
    const uint64_t seed = static_cast<uint64_t>(7 * height + width);
    target = RandomUniform(shape, seed);
    render = ToBuffer(shape, Flat(target) + 0.3f * Flat(RandomNormal(shape, seed + 1000)));
    confidence = RandomUniform({height, width}, seed + 2000);
  }

  void ExpectAsOnTheCpu(const Buffer<float>& u) {
    const PhotometricWeights weights{0.7f, 0.3f};
    Buffer<float> grad = Buffer<float>::Empty(render.shape());
    const PhotometricValue expected = PhotometricLoss()(render, target, u, weights, &grad);
    const Value value = RunOnDevice(render, target, u, weights);
    EXPECT_NEAR(value.l1, expected.l1, 1e-7);
    EXPECT_NEAR(value.dssim, expected.dssim, 1e-6);
    EXPECT_LE(MaxAbsError(value.grad, grad), 1e-5 * static_cast<double>(MaxAbs(grad)));
  }

  Buffer<float> render, target, confidence;
};

TEST_P(CudaPhotometric, IsTheCpusWithoutConfidence) { ExpectAsOnTheCpu({}); }

TEST_P(CudaPhotometric, IsTheSameAChannelAtATime) {
  const PhotometricWeights weights{0.7f, 0.3f};
  const Value together = RunOnDevice(render, target, confidence, weights);
  const Value apart = RunOnDevice(render, target, confidence, weights, MaskMeaning::kConfidence, 1);
  EXPECT_TRUE(Equal(together.grad, apart.grad));
  EXPECT_NEAR(together.l1, apart.l1, 1e-8);
  EXPECT_NEAR(together.dssim, apart.dssim, 1e-8);
}

TEST_P(CudaPhotometric, IsTheCpusWithConfidence) {
  Table(confidence).leftCols((confidence.size(1) + 1) / 2).setZero();
  ExpectAsOnTheCpu(confidence);
}

TEST_P(CudaPhotometric, NothingCountsWithoutAnyConfidence) {
  const Value value = RunOnDevice(render, target, Buffer<float>::Zeros(confidence.shape()), {});
  EXPECT_EQ(value.l1, 0);
  EXPECT_EQ(value.dssim, 0);
  EXPECT_EQ(MaxAbs(value.grad), 0);
}

TEST_P(CudaPhotometric, AMaskHidesTheRenderAsOnTheCpu) {
  const Buffer<float> mask = Above(confidence, 0.4f);
  Buffer<float> grad = Buffer<float>::Empty(render.shape());
  const PhotometricWeights weights{0.8f, 0.2f};
  const double expected = PhotometricLoss()(render, target, {mask, MaskMeaning::kMask}, weights, &grad).loss;
  // What stands where the mask is zero has no say, whatever it is.
  const Buffer<float> noisy = render.Clone();
  for (int64_t i = 0; i < noisy.count(); ++i) {
    if (mask[i / 3] == 0) noisy[i] = 50;
  }
  const Value value = RunOnDevice(noisy, target, mask, weights, MaskMeaning::kMask);
  EXPECT_NEAR(0.8 * value.l1 + 0.2 * value.dssim, expected, 1e-6);
  EXPECT_LE(MaxAbsError(value.grad, grad), 1e-5 * static_cast<double>(MaxAbs(grad)) + 1e-12);
}

TEST_P(CudaPhotometric, BytesAreTheSameToTheBit) {
  const Buffer<uint8_t> bytes = Bytes(target.shape(), Flat(target) + 0.5f / 255);
  const Buffer<uint8_t> mask_bytes = Bytes(confidence.shape(), Flat(confidence));
  const Value packed = RunOnDevice(render, bytes, mask_bytes, {});
  const Value plain = RunOnDevice(render, Floats(bytes), Floats(mask_bytes), {});
  EXPECT_EQ(packed.l1, plain.l1);
  EXPECT_EQ(packed.dssim, plain.dssim);
  EXPECT_TRUE(Equal(packed.grad, plain.grad));
}

INSTANTIATE_TEST_SUITE_P(Sizes, CudaPhotometric,
                         testing::Values(std::pair<int64_t, int64_t>{1, 1}, std::pair<int64_t, int64_t>{16, 32},
                                         std::pair<int64_t, int64_t>{17, 5}, std::pair<int64_t, int64_t>{5, 71},
                                         std::pair<int64_t, int64_t>{37, 53}));

class CudaPhotometricGolden : public CudaTest {};

TEST_F(CudaPhotometricGolden, MatchesTheReference) {
  const SafetensorsFile golden = OpenGolden("ssim");
  const auto image = [&](const char* name) { return Interleaved(GoldenFloat(golden, name)); };
  const Buffer<float> render = image("render"), target = image("target"),
                      confidence = GoldenFloat(golden, "confidence");
  const auto number = [&](const char* name) { return golden.Values<double>(name).at(0); };
  const Value photograph = RunOnDevice(render, target, {}, {0.8f, 0.2f});
  EXPECT_NEAR(photograph.l1, number("l1"), 2e-6);
  EXPECT_NEAR(1 - photograph.dssim, number("ssim"), 2e-6);
  EXPECT_LE(RelativeL2(photograph.grad, Interleaved(GoldenDouble(golden, "grad_loss_photograph"))), 5e-5);
  const Value proposal = RunOnDevice(render, target, confidence, {0.4f, 0.3f});
  EXPECT_NEAR(proposal.dssim, number("dssim_weighted"), 2e-6);
  EXPECT_NEAR(0.4 * proposal.l1 + 0.3 * proposal.dssim, number("loss_proposal"), 2e-6);
  EXPECT_LE(RelativeL2(proposal.grad, Interleaved(GoldenDouble(golden, "grad_loss_proposal"))), 5e-5);
}

}  // namespace
}  // namespace oraclegs::cuda
