#pragma once
// The engine's arrays as tensors and back, without a copy, on the host and on a GPU.

#include "oraclegs/core/buffer.h"
#include "oraclegs/networks/common/tensor.h"

namespace oraclegs {

torch::Device ToTorch(Device device);
Device FromTorch(const torch::Device& device);

/// Tensor over the buffer's numbers, which live as long as either does. Undefined for an undefined buffer.
Tensor TensorOf(const Buffer<float>& buffer);

/// Buffer over the tensor's numbers; a tensor that is not contiguous is copied. Throws ShapeError unless it is float32.
Buffer<float> BufferOf(const Tensor& tensor);

}  // namespace oraclegs
