#pragma once
// Memory of a GPU, and which GPU it is: what code without CUDA asks of it, through the library of device code
// (core/cuda_library.h).

#include <cstdint>

namespace oraclegs::cuda {

/// Device memory for `purpose` ("the tile lists"). Throws OutOfMemory that says how much was asked for, what for, how
/// much is free and which options lower it. The error is cleared: whoever catches it may go on. Null for 0 bytes.
void* AllocateDevice(int64_t bytes, const char* purpose);
/// Host memory that the device copies to without stopping the host.
void* AllocatePinned(int64_t bytes, const char* purpose);
/// `release` is called before memory ends and before it is counted: a library that caches device memory (libtorch does)
/// gives it back then. Null = no callback. Not to be called from several threads at once.
void SetOutOfMemoryCallback(void (*release)());
/// From or to memory of any kind; waits until it is done.
void Copy(void* to, const void* from, int64_t bytes);
/// In order with the default stream.
void FillWithZeros(void* memory, int64_t bytes);
void FreeDevice(void* memory) noexcept;
void FreePinned(void* memory) noexcept;

/// Devices that this build can use now; 0 also when there is no driver, or one that is too old.
int DeviceCount() noexcept;

/// CUDA that the device code was built with: 13000 is 13.0.
int RuntimeVersion() noexcept;

/// Makes device `index` the one that this thread's calls go to. Throws UsageError when there is none of that number.
void UseDevice(int index);

struct DeviceMemory {
  int64_t free, total;  ///< bytes
};
/// After the out-of-memory callback.
DeviceMemory MemoryOfDevice();

}  // namespace oraclegs::cuda
