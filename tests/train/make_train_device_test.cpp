#include "oraclegs/train/make_train_device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/errors.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

TEST(MakeTrainDevice, MakesTheCpus) {
  const TrainOptions options = Options().Settled();
  const LossPlan plan(options, Photos(1));
  EXPECT_NE(MakeTrainDevice(kCpu, {options, plan, 60}), nullptr);
}

TEST(MakeTrainDevice, RefusesDevicesThatTheBuildLacks) {
  const TrainOptions options = Options().Settled();
  const LossPlan plan(options, Photos(1));
  const Device none{static_cast<DeviceKind>(7), 0};
  EXPECT_THAT(MessageOf<UsageError>([&] {
                MakeTrainDevice(none, {options, plan, 60});
              }),
              testing::HasSubstr("--device cpu"));
}

TEST(MakeTrainDevice, RunsPartsOfOtherMethodsOnTheCpuAlone) {
  const TrainOptions options = Options().Settled();
  const LossPlan plan(options, Photos(1));
  const Device gpu{static_cast<DeviceKind>(7), 0};
  EXPECT_THAT(MessageOf<UsageError>([&] {
                MakeTrainDevice(gpu, {options, plan, 60, {nullptr}});
              }),
              testing::HasSubstr("--prune-modes-at work on the CPU only; use --device cpu"));
}

TEST(MakeTrainDevice, KnowsTheDensificationAndDepthOfOtherMethodsOnTheCpuAlone) {
  const Device gpu{static_cast<DeviceKind>(7), 0};
  const auto refusal = [&](const TrainOptions& options) {
    const LossPlan plan(options.Settled(), Photos(1));
    const TrainOptions settled = options.Settled();
    return MessageOf<UsageError>([&] { MakeTrainDevice(gpu, {settled, plan, 60}); });
  };
  TrainOptions options = Options();
  options.baseline.densify = Densify::kAdaptive;
  EXPECT_THAT(refusal(options), testing::HasSubstr("--densify adaptive works on the CPU only"));
  options = Options();
  options.depth_loss = DepthLoss::kCorrelation;
  EXPECT_THAT(refusal(options), testing::HasSubstr("--set depth-loss=correlation works on the CPU only"));
}

}  // namespace
}  // namespace oraclegs
