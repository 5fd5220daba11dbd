#pragma once
// The one tensor type of the program, and the checks at its borders.

#include <torch/types.h>

#include <initializer_list>
#include <string>

#include "oraclegs/core/buffer.h"
#include "oraclegs/core/error.h"

namespace oraclegs {
using torch::Tensor;

/// Throws ShapeError "WHO: NAME is [3, 4] Double, expected contiguous float32 [any, 3]" unless `t` is a contiguous
/// float32 tensor of that shape; -1 stands for any size.
inline void RequireFloat(const char* who, const char* name, const Tensor& t, std::initializer_list<int64_t> shape) {
  bool ok = t.defined() && t.scalar_type() == torch::kFloat && t.is_contiguous() &&
            t.dim() == static_cast<int64_t>(shape.size());
  int64_t i = 0;
  for (const int64_t want : shape) {
    if (!ok) break;
    ok = want == -1 || t.size(i) == want;
    ++i;
  }
  if (ok) return;
  std::string want;
  for (const int64_t s : shape) want += (want.empty() ? "" : ", ") + (s == -1 ? std::string("any") : std::to_string(s));
  if (!t.defined()) throw ShapeError("{}: {} is undefined, expected float32 [{}]", who, name, want);
  throw ShapeError("{}: {} is [{}] {}{}, expected contiguous float32 [{}]", who, name, fmt::join(t.sizes(), ", "),
                   c10::toString(t.scalar_type()), t.is_contiguous() ? "" : " (not contiguous)", want);
}

// The engine's arrays as tensors and back, without a copy, on the host and on a GPU.

torch::Device ToTorch(Device device);
Device FromTorch(const torch::Device& device);

/// Tensor over the buffer's numbers, which live as long as either does. Undefined for an undefined buffer.
Tensor TensorOf(const Buffer<float>& buffer);

/// Buffer over the tensor's numbers; a tensor that is not contiguous is copied. Throws ShapeError unless it is float32.
Buffer<float> BufferOf(const Tensor& tensor);

}  // namespace oraclegs
