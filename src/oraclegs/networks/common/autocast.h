#pragma once
// Mixed precision: weights and norms in float32, products in a half type, as the authors of both large networks run
// them.

#include <optional>

#include "oraclegs/networks/common/tensor.h"

namespace oraclegs {

/// float16 where `device` is a GPU; bfloat16 on a CPU, which has no fast float16.
torch::ScalarType HalfTypeOf(torch::Device device);

/// As long as it lives, matrix products, convolutions and attention on `device` that this thread asks for compute in
/// `products`; norms, softmax and sums stay as they are. Without a type, they compute in their inputs' own type,
/// whatever an outer scope says.
class Autocast {
 public:
  Autocast(torch::Device device, std::optional<torch::ScalarType> products);
  ~Autocast();
  Autocast(const Autocast&) = delete;
  Autocast& operator=(const Autocast&) = delete;

 private:
  torch::Device device_;
  bool enabled_before_;
  torch::ScalarType type_before_;
};

}  // namespace oraclegs
