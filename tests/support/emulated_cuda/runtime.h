#pragma once
// What a test may set and count of the emulated device.

#include <cuda_runtime.h>

namespace emulated_cuda {

/// From now on cudaMalloc fails beyond so many bytes in use; the device starts with 2^40.
void SetMemory(size_t bytes);
/// From now on looking for devices gives this; cudaSuccess: there is one.
void SetDevices(cudaError_t status);
/// From now on cudaGetLastError gives this once.
void SetLastError(cudaError_t error);

/// Since the program began.
struct Counts {
  int64_t allocations;  ///< of device or pinned memory
  int64_t waits;        ///< calls that stop the host until the device has come somewhere
};
Counts CountCalls();

}  // namespace emulated_cuda
