#pragma once
// Golden numbers as tensors, and the error measures of spec/gaussian_core.md 12.

#include "oraclegs/core/buffer.h"
#include "support/golden.h"

namespace oraclegs {

/// A stored tensor converted to float64.
inline Buffer<float> GoldenTensor(const SafetensorsFile& file, const std::string& name) {
  const std::vector<double> values = file.Values<double>(name);
  return torch::tensor(values, torch::kDouble).reshape(file.Get(name).shape);
}

/// The same as contiguous float32, for inputs.
inline Buffer<float> GoldenFloat(const SafetensorsFile& file, const std::string& name) {
  return GoldenTensor(file, name).to(torch::kFloat);
}

/// |x - ref|_2 / |ref|_2 in double.
inline double RelativeL2(const Buffer<float>& x, const Buffer<float>& ref) {
  const Buffer<float> r = ref.to(torch::kDouble);
  return ((x.to(torch::kDouble) - r).norm() / r.norm()).item<double>();
}

inline double MaxAbsError(const Buffer<float>& x, const Buffer<float>& ref) {
  return (x.to(torch::kDouble) - ref.to(torch::kDouble)).abs().max().item<double>();
}

}  // namespace oraclegs
