#pragma once
// Golden numbers as tensors of libtorch, and how far two tensors are apart.

#include <torch/types.h>

#include <string>
#include <vector>

#include "support/golden.h"

namespace oraclegs {

/// Device of networks with golden weights and of their inputs: a GPU within a test of OnThreads (fixtures.h) that runs
/// there.
inline torch::Device& ParityDevice() {
  static torch::Device device = torch::kCPU;
  return device;
}

/// A stored tensor converted to float64.
inline torch::Tensor GoldenTensor(const SafetensorsFile& file, const std::string& name) {
  const std::vector<double> values = file.Values<double>(name);
  return torch::tensor(values, torch::kDouble).reshape(file.Get(name).shape);
}

/// A stored tensor as contiguous float32 on ParityDevice, for inputs.
inline torch::Tensor GoldenFloat(const SafetensorsFile& file, const std::string& name) {
  return GoldenTensor(file, name).to(ParityDevice(), torch::kFloat);
}

/// Largest relative error of a small network in bfloat16 against float. Where the CPU has no instructions for bfloat16,
/// libtorch rounds more often, and errors are up to half as large again.
inline constexpr double kMaxHalfError = 0.1;

/// |x - ref|_2 / |ref|_2 in double.
inline double RelativeL2(const torch::Tensor& x, const torch::Tensor& ref) {
  const torch::Tensor r = ref.to(torch::kCPU, torch::kDouble);
  return ((x.to(torch::kCPU, torch::kDouble) - r).norm() / r.norm()).item<double>();
}

/// Whether x [B, C, H, W] lies in memory with its channels last, and not also with them first.
inline bool HasChannelsLast(const torch::Tensor& x) {
  return x.is_contiguous(at::MemoryFormat::ChannelsLast) && !x.is_contiguous();
}

inline double MaxAbsError(const torch::Tensor& x, const torch::Tensor& ref) {
  return (x.to(torch::kCPU, torch::kDouble) - ref.to(torch::kCPU, torch::kDouble)).abs().max().item<double>();
}

}  // namespace oraclegs
