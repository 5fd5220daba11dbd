#pragma once

#include "oraclegs/train/train_device.h"

namespace oraclegs {

/// Makes the training device of this name. Throws UsageError when this build has none for it, RunError when its memory
/// does not suffice.
std::unique_ptr<TrainDevice> MakeTrainDevice(Device device, const TrainDeviceSetup& setup);

/// Makes the one of the CPU.
std::unique_ptr<TrainDevice> MakeCpuTrainDevice(const TrainDeviceSetup& setup);

namespace cuda {

/// Makes the one of the GPU of this name, which becomes the current one (cuda/cuda_train_device.cpp). Throws UsageError
/// when there is none, RunError when its memory does not suffice for the estimate (memory_estimate.h).
std::unique_ptr<TrainDevice> MakeCudaTrainDevice(Device device, const TrainDeviceSetup& setup);

}  // namespace cuda
}  // namespace oraclegs
