#pragma once

#include "oraclegs/train/train_device.h"

namespace oraclegs {

std::unique_ptr<TrainDevice> MakeCpuTrainDevice(const TrainDeviceSetup& setup);

}  // namespace oraclegs
