// Memory, events and errors of the emulated device. Work is done when it is asked for, so there is nothing to wait for;
// waits are counted all the same.

#include "support/emulated_cuda/runtime.h"

#include <map>

namespace emulated_cuda {
namespace {

struct Device {
  size_t total = size_t{1} << 40, used = 0;
  std::map<void*, size_t> allocated;
  cudaError_t found = cudaSuccess, last_error = cudaSuccess;
  Counts counts{};
};
Device device;

cudaError_t Return(cudaError_t status) {
  if (status != cudaSuccess) device.last_error = status;
  return status;
}

cudaError_t Allocate(void** memory, size_t bytes, size_t limit) {
  ++device.counts.allocations;
  if (bytes > limit) return Return(cudaErrorMemoryAllocation);
  *memory = std::aligned_alloc(256, (bytes + 255) / 256 * 256);
  if (*memory == nullptr) return Return(cudaErrorMemoryAllocation);
  std::memset(*memory, 0xa5, bytes);  // what nobody wrote is no number
  return cudaSuccess;
}

cudaError_t Wait() {
  ++device.counts.waits;
  return cudaSuccess;
}

}  // namespace

void SetMemory(size_t bytes) { device.total = bytes; }
void SetDevices(cudaError_t status) { device.found = status; }
void SetLastError(cudaError_t error) { device.last_error = error; }
Counts CountCalls() { return device.counts; }

}  // namespace emulated_cuda

using emulated_cuda::device;

cudaError_t cudaGetLastError() {
  const cudaError_t error = device.last_error;
  device.last_error = cudaSuccess;
  return error;
}
const char* cudaGetErrorName(cudaError_t error) {
  return error == cudaErrorIllegalAddress ? "cudaErrorIllegalAddress" : "cudaError";
}
const char* cudaGetErrorString(cudaError_t error) {
  return error == cudaErrorIllegalAddress ? "an illegal memory access was encountered" : "an error of the emulation";
}

cudaError_t cudaMalloc(void** memory, size_t bytes) {
  const size_t left = device.total > device.used ? device.total - device.used : 0;
  const cudaError_t status = emulated_cuda::Allocate(memory, bytes, left);
  if (status != cudaSuccess) return status;
  device.allocated[*memory] = bytes;
  device.used += bytes;
  return cudaSuccess;
}
cudaError_t cudaFree(void* memory) {
  const auto at = device.allocated.find(memory);
  if (at == device.allocated.end()) return emulated_cuda::Return(cudaErrorInvalidValue);
  device.used -= at->second;
  device.allocated.erase(at);
  std::free(memory);
  return cudaSuccess;
}
cudaError_t cudaMallocHost(void** memory, size_t bytes) { return emulated_cuda::Allocate(memory, bytes, SIZE_MAX); }
cudaError_t cudaFreeHost(void* memory) {
  std::free(memory);
  return cudaSuccess;
}

cudaError_t cudaMemcpyAsync(void* to, const void* from, size_t bytes, cudaMemcpyKind, cudaStream_t) {
  std::memcpy(to, from, bytes);
  return cudaSuccess;
}
cudaError_t cudaMemcpy(void* to, const void* from, size_t bytes, cudaMemcpyKind) {
  std::memcpy(to, from, bytes);
  return emulated_cuda::Wait();
}
cudaError_t cudaMemsetAsync(void* memory, int byte, size_t bytes, cudaStream_t) {
  std::memset(memory, byte, bytes);
  return cudaSuccess;
}
cudaError_t cudaMemset(void* memory, int byte, size_t bytes) { return cudaMemsetAsync(memory, byte, bytes, nullptr); }
cudaError_t cudaMemGetInfo(size_t* free, size_t* total) {
  *total = device.total;
  *free = device.total > device.used ? device.total - device.used : 0;
  return cudaSuccess;
}

cudaError_t cudaGetDeviceCount(int* count) {
  *count = device.found == cudaSuccess ? 1 : 0;
  return emulated_cuda::Return(device.found);
}
cudaError_t cudaSetDevice(int index) {
  return emulated_cuda::Return(index == 0 ? cudaSuccess : cudaErrorInvalidDevice);
}
cudaError_t cudaGetDevice(int* index) {
  *index = 0;
  return cudaSuccess;
}

cudaError_t cudaDeviceSynchronize() { return emulated_cuda::Wait(); }
cudaError_t cudaStreamSynchronize(cudaStream_t) { return emulated_cuda::Wait(); }
cudaError_t cudaEventSynchronize(cudaEvent_t) { return emulated_cuda::Wait(); }
cudaError_t cudaEventCreate(cudaEvent_t* event) {
  *event = reinterpret_cast<cudaEvent_t>(event);  // any address that is not null
  return cudaSuccess;
}
cudaError_t cudaEventDestroy(cudaEvent_t) { return cudaSuccess; }
cudaError_t cudaEventRecord(cudaEvent_t, cudaStream_t) { return cudaSuccess; }
cudaError_t cudaEventElapsedTime(float* ms, cudaEvent_t, cudaEvent_t) {
  *ms = 0;
  return cudaSuccess;
}
