#pragma once
// Buffers that kernels work on. Not for .cu files: nvcc does not compile buffer.h's error messages.

#include "oraclegs/core/buffer.h"
#include "support/cuda_device.h"

namespace oraclegs {

/// Device of the kernels' buffers: the emulated device's memory is the host's.
inline Device TestDevice() { return kEmulatedCuda ? kCpu : Device{DeviceKind::kCuda, 0}; }

/// A copy in memory of its own.
template <class T>
Buffer<T> OnTestDevice(const Buffer<T>& buffer) {
  return buffer.CopyOn(TestDevice());
}
template <class T>
Buffer<T> OnHost(const Buffer<T>& buffer) {
  return buffer.To(kCpu);
}

}  // namespace oraclegs
