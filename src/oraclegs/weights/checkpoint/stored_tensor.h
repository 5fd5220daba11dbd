#pragma once
// A tensor as it lies in a mapped file: where its numbers are, and how to step through them.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/core/function_ref.h"
#include "oraclegs/weights/checkpoint/pickle_heap.h"

namespace oraclegs {

struct StoredTensor {
  std::string dtype;          ///< as safetensors spells it; "C64" and the like, which it does not have, as well
  int64_t element_bytes = 1;  ///< bytes of one number
  std::vector<int64_t> shape, strides;  ///< strides in elements
  std::string_view bytes;               ///< from its first element to its last, in the file

  /// True when `bytes` is what a file of contiguous tensors holds of it.
  bool IsContiguous() const;
};

/// Row-major strides of a shape.
std::vector<int64_t> ContiguousStrides(const std::vector<int64_t>& shape);

/// The tensor of a pickle, after its storage's bytes are known. Throws InputError with heap.file and `name` when it
/// reaches beyond its storage or has more elements than that: offset, sizes and strides are the file's, and not
/// believed.
StoredTensor StoredTensorOf(const PickleTensor& tensor, const std::string& name, const PickleHeap& heap);

/// Hands over the numbers in the order of their indices, in pieces of at most 16 MB.
void ForEachPiece(const StoredTensor& tensor, FunctionRef<void(std::string_view)> consume);

}  // namespace oraclegs
