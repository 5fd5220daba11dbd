#include "oraclegs/train/cuda/step.h"
#include "oraclegs/train/opacity_factors.h"
#include "support/buffers.h"
#include "support/device_buffers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "oraclegs/core/bfloat16.h"
#include "oraclegs/render/render.h"
#include "oraclegs/train/adam.h"
#include "oraclegs/train/noise.h"
#include "oraclegs/train/regularizers.h"
#include "train/cuda/device_gaussians.h"
#include "train/small_scene.h"

namespace oraclegs::cuda {
namespace {

constexpr int64_t kStepCount = 2 * kStepBlock + 37;
constexpr double kRate = 1e-4;
constexpr RegularizerOptions kRegularizers{0.02, 0.03};

struct TestStep final : GradientConsumer {
  StepConstants step;

  void ConsumeOnDevice(const GaussianBackwardInput& in) override { RunStep(in, step); }
};

class CudaStep : public CudaTest {
 protected:
  Gaussians start = RandomGaussians(kStepCount, 5);
  Buffer<float> upstream = RandomNormal({kHeight, kWidth, 3}, 1);
  LearningRates rates{kRate};
  std::unique_ptr<Rasterizer> rasterizer;

  void SetUp() override {
    CudaTest::SetUp();
    if (IsSkipped()) return;
    rasterizer = MakeCudaRasterizer(TestDevice());
    Flat(start.opacity_logits) -= 4;  // so that the noise moves something
    Flat(upstream) /= 1000;
  }

  static Adam NewAdam(ShMoments sh_moments = ShMoments::kFull) {
    Adam adam(kStepCount, sh_moments);
    adam.ForEachMoment([](const char*, const char*, auto& t) { t = t.CopyOn(TestDevice()); });
    return adam;
  }

  /// A step on the device. Returns the gradients of the image alone, on the host.
  Gaussians OnGpu(int64_t iteration, int degree, Gaussians* gaussians, Adam* adam) {
    rasterizer->Forward(*gaussians, CameraOnCircle(0.3), {{0.1f, 0.2f, 0.3f}, degree, false}, RenderPass::kTrain);
    const RenderGrads image{OnTestDevice(upstream), {}, {}};
    Gaussians grads = OnTestDevice(Gaussians::Zeros(kStepCount));
    rasterizer->Backward(*gaussians, image, &grads);
    const RegularizerSums weights = kRegularizers.PerEntry(kStepCount);
    TestStep consumer;
    consumer.step.params = gaussians->Rows();
    consumer.step.adam = adam->BeginStep(rates, degree, std::as_const(*gaussians));
    consumer.step.moments = adam->Rows();
    consumer.step.regularizers = {static_cast<float>(weights.opacity), static_cast<float>(weights.scale)};
    consumer.step.noise = MeansNoise{9, iteration, kRate}.Constants();
    consumer.step.adds_noise = true;
    rasterizer->BackwardInto(*gaussians, image, &consumer);
    return OnHost(grads);
  }

  static double Value(const Gaussians& gaussians) {
    DeviceArray<RegularizerSums> sums("a test");
    sums.ReserveExactly(StepBlocks(kStepCount));
    RunRegularizerSums({kStepCount, gaussians.Rows(), sums.data()}, nullptr);
    const RegularizerSums weights = kRegularizers.PerEntry(kStepCount);
    double value = 0;
    for (const RegularizerSums& block : ToHost(sums, StepBlocks(kStepCount))) {
      value += weights.opacity * block.opacity + weights.scale * block.scale;
    }
    return value;
  }
};

TEST_F(CudaStep, IsRegularizersAdamAndNoiseOfTheCpu) {
  for (const int degree : {0, 1, 2, 3}) {
    Gaussians expected = start.Clone(), gaussians = OnTestDevice(start);
    Adam expected_adam(kStepCount), adam = NewAdam();
    for (int64_t i = 1; i <= 3; ++i) {
      const double value = Value(gaussians);
      Gaussians grads = OnGpu(i, degree, &gaussians, &adam);
      EXPECT_GT(MaxAbs(grads.means), 0);
      EXPECT_NEAR(AddRegularizers(expected, kRegularizers, &grads), value, 1e-6 * value);
      expected_adam.Step(grads, rates, degree, &expected);
      AddNoise({9, i, kRate}, &expected);
    }
    EXPECT_EQ(adam.step, 3);
    EXPECT_GT(MaxAbsError(expected.means, start.means), 1e-4);
    ExpectClose(OnHost(gaussians), expected, 1e-5);
    ExpectClose(OnHost(adam.m), expected_adam.m, 1e-6);
    ExpectClose(OnHost(adam.v), expected_adam.v, 1e-6);
    if (degree == kMaxShDegree) continue;
    const int inactive = kShFloats - 3 * ShCount(degree);
    const Buffer<float> sh = OnHost(gaussians.sh), v = OnHost(adam.v.sh);
    EXPECT_TRUE((Table(sh).rightCols(inactive) == Table(start.sh).rightCols(inactive)).all());
    EXPECT_EQ(Table(v).rightCols(inactive).abs().maxCoeff(), 0);
  }
}

TEST_F(CudaStep, CompactMomentsAreThoseOfTheCpu) {
  for (const int degree : {0, 1, 3}) {
    Gaussians expected = start.Clone(), gaussians = OnTestDevice(start);
    Adam expected_adam(kStepCount, ShMoments::kCompact), adam = NewAdam(ShMoments::kCompact);
    for (int64_t i = 1; i <= 3; ++i) {
      Gaussians grads = OnGpu(i, degree, &gaussians, &adam);
      expected_adam.Step(grads, rates, degree, &expected);
    }
    EXPECT_GT(MaxAbsError(expected.sh, start.sh), 1e-3);
    // A first moment may fall to either side where two bfloat16 numbers are equally near.
    EXPECT_LE(MaxAbsError(OnHost(gaussians.sh), expected.sh), 1e-5);
    EXPECT_LE(MaxAbsError(OnHost(adam.sh_v), expected_adam.sh_v), 1e-6 * MaxAbs(expected_adam.sh_v));
    const Buffer<uint16_t> m = OnHost(adam.sh_m);
    for (int64_t k = 0; k < m.count(); ++k) {
      const float wanted = FromBfloat16(expected_adam.sh_m[k]);
      EXPECT_NEAR(FromBfloat16(m[k]), wanted, 0x1p-7 * std::abs(wanted)) << k;
    }
  }
}

TEST_F(CudaStep, HalfMomentsAreNearThoseOfTheCpu) {
  for (const int degree : {0, 1, 3}) {
    Gaussians expected = start.Clone(), gaussians = OnTestDevice(start);
    Adam expected_adam(kStepCount, ShMoments::kHalf), adam = NewAdam(ShMoments::kHalf);
    for (int64_t i = 1; i <= 3; ++i) {
      Gaussians grads = OnGpu(i, degree, &gaussians, &adam);
      expected_adam.Step(grads, rates, degree, &expected);
    }
    EXPECT_GT(MaxAbsError(expected.sh, start.sh), 1e-3);
    // A second moment is rounded up here and down there, each by up to 1/128, in each of three steps.
    EXPECT_LE(MaxAbsError(OnHost(gaussians.sh), expected.sh), 0.02 * MaxAbsError(expected.sh, start.sh));
    const Buffer<uint16_t> m = OnHost(adam.sh_m), v = OnHost(adam.sh_v_half);
    for (int64_t k = 0; k < m.count(); ++k) {
      const float wanted_m = FromBfloat16(expected_adam.sh_m[k]), wanted_v = FromBfloat16(expected_adam.sh_v_half[k]);
      EXPECT_NEAR(FromBfloat16(m[k]), wanted_m, 0x1p-6 * std::abs(wanted_m)) << k;
      EXPECT_NEAR(FromBfloat16(v[k]), wanted_v, 3 * 0x1p-6 * wanted_v) << k;
    }
  }
}

TEST_F(CudaStep, MomentsDoNotStayAmongTheSubnormalNumbers) {
  Gaussians gaussians = OnTestDevice(start);
  upstream.SetZero();
  Adam adam(kStepCount);
  for (Gaussians* moment : {&adam.m, &adam.v}) {
    moment->ForEach([](const char*, Buffer<float>& t) { Flat(t).setConstant(1.2e-38f); });
    *moment = OnTestDevice(*moment);
  }
  OnGpu(1, 3, &gaussians, &adam);
  EXPECT_EQ(MaxAbs(OnHost(adam.m.sh)), 0);
  EXPECT_EQ(MaxAbs(OnHost(adam.m.means)), 0);
}

TEST_F(CudaStep, NoiseIsTheCpus) {
  const MeansNoise noise{0x123456789abcdef0, 77, 1e-5};
  Gaussians expected = start.Clone();
  AddNoise(noise, &expected);
  const Gaussians gaussians = OnTestDevice(start);
  RunNoise({kStepCount, gaussians.Rows(), noise.Constants()}, nullptr);
  const Buffer<float> means = OnHost(gaussians.means);
  const double moved = MaxAbsError(expected.means, start.means);
  EXPECT_GT(moved, 0.01);
  EXPECT_LE(MaxAbsError(means, expected.means), 2e-5 * moved);
  EXPECT_TRUE(Equal(OnHost(gaussians.quats), start.quats));
}

class CudaOpacityFactors : public CudaTest {};

TEST_F(CudaOpacityFactors, AreTheCpus) {
  constexpr int64_t kCount = 777;
  for (const auto& [drop, noise] : {std::pair{0.2, 0.0}, std::pair{0.0, 0.8}, std::pair{0.5, 3.0}}) {
    const Buffer<float> expected = Buffer<float>::Empty({kCount});
    DrawOpacityFactors({5, 123, drop, noise}, expected);
    const Buffer<float> factors = OnTestDevice(Buffer<float>::Full({kCount}, -1.f));
    RunOpacityFactors({5, 123, drop, noise, kCount, factors.data()}, nullptr);
    const Buffer<float> drawn = OnHost(factors);
    EXPECT_LE(MaxAbsError(drawn, expected), 1e-5);  // floats of up to 36
    EXPECT_TRUE(((Flat(drawn) == 0) == (Flat(expected) == 0)).all());
  }
}

}  // namespace

}  // namespace oraclegs::cuda
