#pragma once
// Tensors that kernels work on: on the emulated device the host's.

#include "oraclegs/core/buffer.h"
#include "support/cuda_device.h"

namespace oraclegs {

inline Device TestDevice() {
  return kEmulatedCuda ? Device(kCpu) : Device(torch::kCUDA, 0);
}

/// A copy in memory of its own.
inline Buffer<float> OnTestDevice(const Buffer<float>& t) { return t.defined() ? t.Clone().to(TestDevice()) : t; }

inline Buffer<float> OnHost(const Buffer<float>& t) { return t.To(kCpu); }

}  // namespace oraclegs
