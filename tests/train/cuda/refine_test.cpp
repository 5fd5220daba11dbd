#include "oraclegs/train/cuda/refine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "oraclegs/train/mcmc.h"
#include "train/cuda/device_gaussians.h"

namespace oraclegs::cuda {
namespace {

constexpr int64_t kRefineCount = 3 * 256 + 19;

class CudaRefine : public CudaTest {
 protected:
  Gaussians start = RandomGaussians(kRefineCount, 5);
  DeviceArray<uint64_t> weights{"a test"}, ranks{"a test"}, totals{"a test"};
  DeviceArray<int> sources{"a test"}, draws{"a test"};
  DeviceArray<double> choose{"a test"};

  void SetUp() override {
    CudaTest::SetUp();
    for (int64_t i = 0; i < kRefineCount; i += 7) start.opacity_logits[i] = -7;  // dead
    start.opacity_logits[1] = 60;                                                // opacity 1
  }

  static Adam Moments() {
    Adam adam(0);
    adam.m = RandomGaussians(kRefineCount, 6);
    adam.v = RandomGaussians(kRefineCount, 7);
    return adam;
  }

  static Adam SmallMoments(ShMoments sh_moments) {
    Adam adam(kRefineCount, sh_moments);
    std::iota(adam.sh_m.span().begin(), adam.sh_m.span().end(), 1);
    std::iota(adam.sh_v_half.span().begin(), adam.sh_v_half.span().end(), 2);
    std::iota(adam.sh_v.span().begin(), adam.sh_v.span().end(), 1.f);
    return adam;
  }
  static void ExpectSameSh(const Adam& on_device, const Adam& expected) {
    EXPECT_TRUE(Equal(OnHost(on_device.sh_m), expected.sh_m));
    if (expected.sh_moments() == ShMoments::kHalf) {
      EXPECT_TRUE(Equal(OnHost(on_device.sh_v_half), expected.sh_v_half));
    } else {
      EXPECT_TRUE(Equal(OnHost(on_device.sh_v), expected.sh_v));
    }
  }

  RefineInput Input(int64_t iteration, const Gaussians& gaussians, const Adam& adam) {
    std::vector<double> table;
    for (const auto& row : Binomials()) table.insert(table.end(), row.begin(), row.end());
    choose.Upload(table.data(), static_cast<int64_t>(table.size()));
    for (DeviceArray<uint64_t>* array : {&weights, &ranks, &totals}) array->Reserve(kRefineCount);
    for (DeviceArray<int>* array : {&sources, &draws}) array->Reserve(kRefineCount);
    RefineInput in;
    in.seed = 3;
    in.iteration = iteration;
    in.count = kRefineCount;
    in.params = gaussians.Rows();
    in.moments = adam.Rows();
    in.scratch = {weights.data(), ranks.data(), totals.data(), sources.data(), draws.data(), choose.data()};
    return in;
  }

  static Adam OnTestDevice(const Adam& adam) {
    Adam copy = adam;
    copy.ForEachMoment([](const char*, const char*, auto& t) { t = t.CopyOn(TestDevice()); });
    return copy;
  }
};

TEST_F(CudaRefine, RelocatesAsTheCpuDoes) {
  Gaussians expected = start.Clone();
  Adam expected_adam = Moments();
  ASSERT_GT(RelocateDead(3, 600, &expected, &expected_adam), 0);
  const Gaussians gaussians = oraclegs::OnTestDevice(start);
  const Adam adam = OnTestDevice(Moments());
  RunRelocate(Input(600, gaussians, adam), nullptr);
  ExpectClose(OnHost(gaussians), expected, 1e-6);
  EXPECT_TRUE(Equal(OnHost(gaussians.means), expected.means));  // the same sources
  EXPECT_TRUE(SameBits(OnHost(adam.m), expected_adam.m));
  EXPECT_TRUE(SameBits(OnHost(adam.v), expected_adam.v));
}

TEST_F(CudaRefine, ZeroesSmallMomentsAsTheCpuDoes) {
  for (const ShMoments sh_moments : {ShMoments::kHalf, ShMoments::kCompact}) {
    Gaussians expected = start.Clone();
    Adam expected_adam = SmallMoments(sh_moments), adam = OnTestDevice(SmallMoments(sh_moments));
    ASSERT_GT(RelocateDead(3, 600, &expected, &expected_adam), 0);
    Gaussians gaussians = oraclegs::OnTestDevice(start);
    RunRelocate(Input(600, gaussians, adam), nullptr);
    ExpectSameSh(adam, expected_adam);
    EXPECT_TRUE(Equal(OnHost(adam.m.quats), expected_adam.m.quats));

    const int64_t added = AddGaussians(3, 700, 100000, &expected, &expected_adam);
    ASSERT_EQ(added, kRefineCount / 20);
    const auto grow = [&](auto& t) { t = t.GrownTo(kRefineCount + added); };
    gaussians.ForEach([&](const char*, Buffer<float>& t) { grow(t); });
    adam.ForEachMoment([&](const char*, const char*, auto& t) { grow(t); });
    const RefineInput in = Input(700, gaussians, adam);
    RunWeigh(in, nullptr);
    RunGrow(in, added, nullptr);
    ExpectSameSh(adam, expected_adam);
  }
}

TEST_F(CudaRefine, NothingHappensWhenAllLiveOrAllAreDead) {
  for (const float logit : {0.f, -9.f}) {
    Flat(start.opacity_logits).setConstant(logit);
    const Gaussians gaussians = oraclegs::OnTestDevice(start);
    const Adam adam = OnTestDevice(Moments());
    RunRelocate(Input(600, gaussians, adam), nullptr);
    EXPECT_TRUE(SameBits(OnHost(gaussians), start));
    EXPECT_TRUE(SameBits(OnHost(adam.m), Moments().m));
  }
}

TEST_F(CudaRefine, WhatIsNotANumberIsNeverDrawn) {
  start.opacity_logits[3] = std::nanf("");
  const Gaussians gaussians = oraclegs::OnTestDevice(start);
  const Adam adam = OnTestDevice(Moments());
  RunRelocate(Input(600, gaussians, adam), nullptr);
  EXPECT_TRUE(AllFinite(OnHost(gaussians.opacity_logits)));
}

TEST_F(CudaRefine, GrowsAsTheCpuDoes) {
  Gaussians expected = start.Clone();
  Adam expected_adam = Moments();
  const int64_t added = AddGaussians(3, 700, 100000, &expected, &expected_adam);
  ASSERT_EQ(added, kRefineCount / 20);
  Gaussians gaussians = oraclegs::OnTestDevice(start);
  Adam adam = OnTestDevice(Moments());
  for (Gaussians* rows : {&gaussians, &adam.m, &adam.v}) {
    rows->ForEach([&](const char*, Buffer<float>& t) { t = t.GrownTo(kRefineCount + added); });
  }
  const RefineInput in = Input(700, gaussians, adam);
  RunWeigh(in, nullptr);
  EXPECT_GT(ToHost(weights, kRefineCount).back(), 0u);
  RunGrow(in, added, nullptr);
  ExpectClose(OnHost(gaussians), expected, 1e-6);
  EXPECT_TRUE(Equal(OnHost(gaussians.means), expected.means));
  EXPECT_TRUE(SameBits(OnHost(adam.m), expected_adam.m));
  EXPECT_TRUE(SameBits(OnHost(adam.v), expected_adam.v));
}

TEST_F(CudaRefine, RunningSumsAreExact) {
  const Gaussians gaussians = oraclegs::OnTestDevice(start);
  const Adam adam = OnTestDevice(Moments());
  RunWeigh(Input(600, gaussians, adam), nullptr);
  const std::vector<uint64_t> sums = ToHost(weights, kRefineCount);
  uint64_t before = 0;
  for (int64_t i = 0; i < kRefineCount; ++i) {
    const double opacity = OpacityOf(start.opacity_logits[i]);
    EXPECT_NEAR(static_cast<double>(sums[i] - before) * 0x1p-36, opacity, 1e-10) << i;
    before = sums[i];
  }
}

}  // namespace
}  // namespace oraclegs::cuda
