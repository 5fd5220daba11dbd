#include "oraclegs/core/cuda/memory.h"

#include "oraclegs/core/cuda/check.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"

namespace oraclegs::cuda {
namespace {

void (*g_release_memory)() = nullptr;

[[noreturn]] void ThrowOutOfMemory(int64_t bytes, const char* purpose, const char* where) {
  cudaGetLastError();  // reported here: later calls must not report it again
  size_t free = 0, total = 0;
  if (cudaMemGetInfo(&free, &total) != cudaSuccess) cudaGetLastError();
  throw OutOfMemory(
      "out of {} memory: {:.2f} GB for {}, with {:.2f} of {:.2f} GB free on the GPU; lower --max-gaussians or "
      "--set random-points, or raise --downscale",
      where, Gigabytes(bytes), purpose, Gigabytes(static_cast<int64_t>(free)), Gigabytes(static_cast<int64_t>(total)));
}

}  // namespace

void* AllocateDevice(int64_t bytes, const char* purpose) {
  if (bytes == 0) return nullptr;
  void* memory = nullptr;
  cudaError_t status = cudaMalloc(&memory, static_cast<size_t>(bytes));
  if (status == cudaErrorMemoryAllocation && g_release_memory != nullptr) {
    cudaGetLastError();
    g_release_memory();
    status = cudaMalloc(&memory, static_cast<size_t>(bytes));
  }
  if (status == cudaErrorMemoryAllocation) ThrowOutOfMemory(bytes, purpose, "GPU");
  Check(status, purpose);
  return memory;
}

void* AllocatePinned(int64_t bytes, const char* purpose) {
  if (bytes == 0) return nullptr;
  void* memory = nullptr;
  const cudaError_t status = cudaMallocHost(&memory, static_cast<size_t>(bytes));
  if (status == cudaErrorMemoryAllocation) ThrowOutOfMemory(bytes, purpose, "pinned host");
  Check(status, purpose);
  return memory;
}

void SetOutOfMemoryCallback(void (*release)()) { g_release_memory = release; }

void Copy(void* to, const void* from, int64_t bytes) {
  Check(cudaMemcpy(to, from, static_cast<size_t>(bytes), cudaMemcpyDefault), "copying between the host and the GPU");
}

void FillWithZeros(void* memory, int64_t bytes) {
  Check(cudaMemsetAsync(memory, 0, static_cast<size_t>(bytes), nullptr), "clearing memory of the GPU");
}

void FreeDevice(void* memory) noexcept {
  if (memory != nullptr && cudaFree(memory) != cudaSuccess) cudaGetLastError();  // at exit the driver may be gone
}

void FreePinned(void* memory) noexcept {
  if (memory != nullptr && cudaFreeHost(memory) != cudaSuccess) cudaGetLastError();
}

int DeviceCount() noexcept {
  int count = 0;
  if (cudaGetDeviceCount(&count) == cudaSuccess) return count;
  cudaGetLastError();
  return 0;
}

int RuntimeVersion() noexcept { return CUDART_VERSION; }

void UseDevice(int index) {
  int count = 0;
  Check(cudaGetDeviceCount(&count), "looking for a GPU");
  if (count == 0) Check(cudaErrorNoDevice, "looking for a GPU");
  if (index < 0 || index >= count) {
    throw UsageError("--device cuda:{}: this machine has {} NVIDIA GPU{}, numbered from 0", index, count,
                     count == 1 ? "" : "s");
  }
  Check(cudaSetDevice(index), "choosing the GPU");
}

DeviceMemory MemoryOfDevice() {
  if (g_release_memory != nullptr) g_release_memory();
  size_t free = 0, total = 0;
  Check(cudaMemGetInfo(&free, &total), "asking for the GPU's memory");
  return {static_cast<int64_t>(free), static_cast<int64_t>(total)};
}

}  // namespace oraclegs::cuda
