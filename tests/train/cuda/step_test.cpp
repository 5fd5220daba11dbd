#include "oraclegs/train/cuda/step.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/train/adam.h"
#include "oraclegs/train/mcmc.h"
#include "support/buffers.h"
#include "train/cuda/device_gaussians.h"

namespace oraclegs::cuda {
namespace {

constexpr int64_t kCount = 2 * kStepBlock + 37, kFirstBlock = 192;
constexpr double kOpacityReg = 0.02, kScaleReg = 0.03, kRate = 1e-4;

class CudaStep : public CudaTest {
 protected:
  Gaussians grads = RandomGaussians(kCount, 4);
  Gaussians start = RandomGaussians(kCount, 5);
  LearningRates rates{kRate};

  void SetUp() override {
    CudaTest::SetUp();
    start.opacity_logits -= 4;  // so that the noise moves something
    grads.sh.narrow(0, 5, 40).SetZero();
  }

  /// Steps on the CPU, and the value of the regularisers in the last one.
  double OnCpu(int steps, int degree, Gaussians* gaussians, Adam* adam) {
    double value = 0;
    for (int i = 1; i <= steps; ++i) {
      Gaussians g = Copy(grads);
      value = AddRegularizers(*gaussians, kOpacityReg, kScaleReg, &g);
      adam->Step(g, rates, degree, gaussians);
      AddNoise({9, i, kRate}, gaussians);
    }
    return value;
  }

  double OnGpu(int steps, int degree, Gaussians* gaussians, Adam* adam) {
    const Gaussians g = OnTestDevice(grads);
    double value = 0;
    for (int i = 1; i <= steps; ++i) {
      value = Value(*gaussians);
      StepConstants step;
      step.regularizers = {static_cast<float>(kOpacityReg / kCount), static_cast<float>(kScaleReg / (3 * kCount))};
      step.adam = adam->BeginStep(rates, degree, std::as_const(*gaussians));
      step.noise = {9, static_cast<uint32_t>(i), static_cast<float>(kNoiseRate * kRate)};
      step.adds_noise = true;
      for (const int64_t first : {int64_t{0}, kFirstBlock}) {  // in two blocks of gradients
        step.first = first;
        step.params = gaussians->Rows().From(first);
        step.m = adam->m.Rows().From(first);
        step.v = adam->v.Rows().From(first);
        RunStep(step, g.Rows().From(first), first == 0 ? kFirstBlock : kCount - kFirstBlock, nullptr);
      }
    }
    return value;
  }

  static double Value(const Gaussians& gaussians) {
    DeviceArray<RegularizerBlock> sums("a test");
    sums.ReserveExactly(StepBlocks(kCount));
    RunRegularizerSums({kCount, gaussians.Rows(), sums.data()}, nullptr);
    double value = 0;
    for (const RegularizerBlock& block : ToHost(sums, StepBlocks(kCount))) {
      value += kOpacityReg * block.opacity / kCount + kScaleReg * block.scale / (3 * kCount);
    }
    return value;
  }
};

TEST_F(CudaStep, IsRegularisersAdamAndNoiseOfTheCpu) {
  for (const int degree : {0, 1, 2, 3}) {
    Gaussians expected = Copy(start), gaussians = OnTestDevice(start);
    Adam expected_adam(kCount), adam(kCount);
    adam.m = OnTestDevice(adam.m);
    adam.v = OnTestDevice(adam.v);
    const double value = OnCpu(3, degree, &expected, &expected_adam);
    EXPECT_NEAR(OnGpu(3, degree, &gaussians, &adam), value, 1e-6 * value);
    EXPECT_EQ(adam.step, 3);
    ExpectClose(OnHost(gaussians), expected, 1e-5);
    ExpectClose(OnHost(adam.m), expected_adam.m, 1e-6);
    ExpectClose(OnHost(adam.v), expected_adam.v, 1e-6);
    const int active = ShCount(degree);
    if (degree == 3) continue;
    EXPECT_TRUE(
        torch::equal(OnHost(gaussians.sh).narrow(1, active, 16 - active), start.sh.narrow(1, active, 16 - active)));
    EXPECT_EQ(OnHost(adam.v.sh).narrow(1, active, 16 - active).abs().max().item<float>(), 0);
  }
}

TEST_F(CudaStep, MomentsDoNotStayAmongTheSubnormalNumbers) {
  Gaussians gaussians = OnTestDevice(start);
  grads = Gaussians::Zeros(kCount);
  Adam adam(kCount);
  adam.m.ForEach([](const char*, Buffer<float>& t) { t.fill_(1.2e-38f); });
  adam.v.ForEach([](const char*, Buffer<float>& t) { t.fill_(1.2e-38f); });
  adam.m = OnTestDevice(adam.m);
  adam.v = OnTestDevice(adam.v);
  OnGpu(1, 3, &gaussians, &adam);
  EXPECT_EQ(OnHost(adam.m.sh).abs().max().item<float>(), 0);
  EXPECT_EQ(OnHost(adam.m.means).abs().max().item<float>(), 0);
}

TEST_F(CudaStep, NoiseIsTheCpus) {
  Gaussians expected = Copy(start);
  AddNoise({0x123456789abcdef0, 77, 1e-5}, &expected);
  const Gaussians gaussians = OnTestDevice(start);
  RunNoise({kCount, gaussians.Rows(), {0x123456789abcdef0, 77, static_cast<float>(kNoiseRate * 1e-5)}}, nullptr);
  const Buffer<float> moved = OnHost(gaussians.means) - start.means, wanted = expected.means - start.means;
  EXPECT_GT(wanted.abs().max().item<float>(), 0.01f);
  EXPECT_LE(MaxAbsError(moved, wanted), 2e-5 * wanted.abs().max().item<double>());
  EXPECT_TRUE(torch::equal(OnHost(gaussians.quats), start.quats));
}

}  // namespace
}  // namespace oraclegs::cuda
