#pragma once
// Mixed precision: weights and norms in float32, products in a half type, as the authors of both large networks run
// them.

#include <optional>

#include "oraclegs/networks/common/tensor.h"

namespace oraclegs {

/// float16 where `device` is a GPU; bfloat16 on a CPU, which has no fast float16.
torch::ScalarType HalfTypeOf(torch::Device device);

/// While it lives, matrix products, convolutions and attention that this thread runs on `device` compute in `products`;
/// norms, softmax and sums are unaffected. Without a type, each operation computes in the type of its inputs, whatever
/// an outer scope says.
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
