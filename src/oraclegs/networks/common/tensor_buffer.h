#pragma once
// The engine's arrays as tensors and back, without a copy, on the host and on a GPU.

#include "oraclegs/core/buffer.h"
#include "oraclegs/networks/common/tensor.h"

namespace oraclegs {

torch::Device ToTorch(Device device);
Device FromTorch(const torch::Device& device);

/// The buffer's numbers; they live as long as either does. Undefined for an undefined buffer.
Tensor TensorOf(const Buffer<float>& buffer);

/// The tensor's numbers; of one that is not contiguous a copy. Throws ShapeError unless it is float32.
Buffer<float> BufferOf(const Tensor& tensor);

}  // namespace oraclegs
