#pragma once

#include <torch/cuda.h>

#include "oraclegs/networks/common/parameters.h"

namespace oraclegs {

/// Made-up weights on their device and in their type.
class PlacedParameters : public ParameterSource {
 public:
  PlacedParameters(torch::Device device, torch::ScalarType type) : device_(device), type_(type), random_(1) {}
  Tensor Get(const std::string& name, at::IntArrayRef shape) override {
    return random_.Get(name, shape).to(device_, type_);
  }
  void Unused(const std::string&, at::IntArrayRef) override {}

 private:
  torch::Device device_;
  torch::ScalarType type_;
  RandomParameters random_;
};

/// Waits until all work on the device is done.
inline void WaitFor(torch::Device device) {
  if (device.is_cuda()) torch::cuda::synchronize();
}

}  // namespace oraclegs
