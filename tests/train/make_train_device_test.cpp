#include "oraclegs/train/make_train_device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/errors.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

TEST(MakeTrainDevice, MakesTheCpus) {
  const TrainOptions options = Options();
  const LossPlan plan(options, Photos(1));
  EXPECT_NE(MakeTrainDevice(kCpu, {options, plan, 60}), nullptr);
}

TEST(MakeTrainDevice, RefusesDevicesThatTheBuildLacks) {
  const TrainOptions options = Options();
  const LossPlan plan(options, Photos(1));
  const Device none{static_cast<DeviceKind>(7), 0};
  EXPECT_THAT(MessageOf<UsageError>([&] {
                MakeTrainDevice(none, {options, plan, 60});
              }),
              testing::HasSubstr("--device cpu"));
}

}  // namespace
}  // namespace oraclegs
