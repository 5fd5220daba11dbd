#pragma once
// Tensors that kernels work on: on the emulated device the host's.

#include "oraclegs/core/tensor.h"
#include "support/cuda_device.h"

namespace oraclegs {

inline torch::Device TestDevice() {
  return kEmulatedCuda ? torch::Device(torch::kCPU) : torch::Device(torch::kCUDA, 0);
}

/// A copy in memory of its own.
inline Tensor OnTestDevice(const Tensor& t) { return t.defined() ? t.clone().to(TestDevice()) : t; }

inline Tensor OnHost(const Tensor& t) { return t.to(torch::kCPU); }

}  // namespace oraclegs
