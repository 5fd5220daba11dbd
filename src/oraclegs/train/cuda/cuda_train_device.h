#pragma once

#include "oraclegs/train/train_device.h"

namespace oraclegs::cuda {

/// Makes the trainer of the GPU of this name, which becomes the current one. Throws UsageError when there is none,
/// RunError when its memory does not suffice for the estimate (memory_estimate.h).
std::unique_ptr<TrainDevice> MakeCudaTrainDevice(Device device, const TrainDeviceSetup& setup);

}  // namespace oraclegs::cuda
