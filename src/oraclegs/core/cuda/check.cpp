#include "oraclegs/core/cuda/check.h"

#include "oraclegs/core/error.h"

namespace oraclegs::cuda {

void Check(cudaError_t status, const char* what) {
  if (status == cudaSuccess) return;
  cudaGetLastError();
  switch (status) {
    case cudaErrorNoDevice:
      throw UsageError("{}: this machine has no NVIDIA GPU that is free for use; use --device cpu", what);
    case cudaErrorInsufficientDriver:
      throw UsageError(
          "{}: this machine has no NVIDIA driver, or one older than this program's CUDA {}.{}; install or update the "
          "driver, or use --device cpu",
          what, CUDART_VERSION / 1000, CUDART_VERSION % 1000 / 10);
    case cudaErrorNoKernelImageForDevice:
      throw UsageError(
          "{}: this program was built for another GPU; build it with -DCMAKE_CUDA_ARCHITECTURES=native, or use "
          "--device cpu",
          what);
    default:
      throw RunError("{}: {} ({})", what, cudaGetErrorString(status), cudaGetErrorName(status));
  }
}

void CheckLaunch(const char* kernel) { Check(cudaGetLastError(), kernel); }

}  // namespace oraclegs::cuda
