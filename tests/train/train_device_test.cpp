#include "oraclegs/train/train_device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "train/small_scene.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

TEST(TrainDeviceTest, TheCpuIsAlwaysThere) {
  const TrainOptions options = Options().Settled();
  ViewLoss view_loss(options, Photographs(1));
  EXPECT_NE(MakeTrainDevice(kCpu, {options, &view_loss, 60}), nullptr);
}

TEST(TrainDeviceTest, ADeviceThatTheBuildHasNotIsRefused) {
  const TrainOptions options = Options().Settled();
  ViewLoss view_loss(options, Photographs(1));
  try {
    MakeTrainDevice(Device{static_cast<DeviceKind>(7), 0}, {options, &view_loss, 60});
    FAIL() << "there is no such device";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--device cpu"));
  }
}

}  // namespace
}  // namespace oraclegs
