#include "oraclegs/train/make_train_device.h"

#include "oraclegs/core/config.h"
#include "oraclegs/train/cpu_train_device.h"
#if defined(ORACLEGS_CUDA)
#include "oraclegs/train/cuda/cuda_train_device.h"
#endif

namespace oraclegs {

std::unique_ptr<TrainDevice> MakeTrainDevice(Device device, const TrainDeviceSetup& setup) {
  if (device.is_cpu()) return MakeCpuTrainDevice(setup);
  if (setup.options.baseline.densify != Densify::kMcmc) {
    throw UsageError("--densify {} works on the CPU only; use --device cpu", Word(setup.options.baseline.densify));
  }
  if (const DepthLoss loss = setup.options.depth_loss; loss > DepthLoss::kPaper) {
    throw UsageError("--set depth-loss={} works on the CPU only; use --device cpu", Word(loss));
  }
  if (!setup.parts.empty()) {
    throw UsageError(
        "--hard-depth, --soft-depth-start, --pseudo-depth-weight and --prune-modes-at work on the CPU only; "
        "use --device cpu");
  }
#if defined(ORACLEGS_CUDA)
  if (device.is_cuda()) return cuda::MakeCudaTrainDevice(device, setup);
#endif
  throw UsageError("this build trains on the CPU only, '{}' was asked for; use --device cpu", device.Name());
}

}  // namespace oraclegs
