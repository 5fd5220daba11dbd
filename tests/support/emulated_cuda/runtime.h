#pragma once
// What a test may set and count of the emulated device.

#include <cuda_runtime.h>

namespace emulated_cuda {

/// Makes cudaMalloc fail beyond so many bytes in use; the device starts with 2^40.
void SetMemory(size_t bytes);
/// Makes looking for devices return this status; cudaSuccess: there is one.
void SetDevices(cudaError_t status);
/// Makes the next cudaGetLastError return this error.
void SetLastError(cudaError_t error);

/// Counts since the program began.
struct Counts {
  int64_t allocations;  ///< allocations of device or pinned memory
  int64_t waits;        ///< calls that block the host until the device has reached some point
};
Counts CountCalls();

}  // namespace emulated_cuda
