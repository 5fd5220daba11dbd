#pragma once

#include "oraclegs/train/train_device.h"

namespace oraclegs {

/// Makes the training device of this name. Throws UsageError when this build has none for it, RunError when its memory
/// does not suffice.
std::unique_ptr<TrainDevice> MakeTrainDevice(Device device, const TrainDeviceSetup& setup);

}  // namespace oraclegs
