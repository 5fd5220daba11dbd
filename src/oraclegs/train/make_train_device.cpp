#include "oraclegs/train/make_train_device.h"

#include "oraclegs/core/config.h"
#include "oraclegs/train/cpu_train_device.h"
#if defined(ORACLEGS_CUDA)
#include "oraclegs/train/cuda/cuda_train_device.h"
#endif

namespace oraclegs {

std::unique_ptr<TrainDevice> MakeTrainDevice(Device device, const TrainDeviceSetup& setup) {
  if (device.is_cpu()) return MakeCpuTrainDevice(setup);
#if defined(ORACLEGS_CUDA)
  if (device.is_cuda()) return cuda::MakeCudaTrainDevice(device, setup);
#endif
  throw UsageError("this build trains on the CPU only, '{}' was asked for; use --device cpu", device.Name());
}

}  // namespace oraclegs
