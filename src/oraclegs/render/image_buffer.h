#pragma once

#include <vector>

#include "oraclegs/core/buffer.h"

namespace oraclegs {

/// One float32 image at a time, of any shape, in a storage that grows to the largest. The handle of a shape is made
/// once and kept, so that later calls allocate nothing.
class ImageBuffer {
 public:
  /// Makes an empty one. `purpose`, a plural noun, appears in the error when memory ends.
  explicit ImageBuffer(Device device = kCpu, const char* purpose = "the images") : device_(device), purpose_(purpose) {}

  /// Buffer of this shape on the device, uninitialized. All buffers of one ImageBuffer share their memory: use it until
  /// the next Get.
  const Buffer<float>& Get(const Shape& shape);

 private:
  Device device_;
  const char* purpose_;
  Buffer<float> storage_;             // [count]
  std::vector<Buffer<float>> views_;  // into storage_, of different shapes
};

}  // namespace oraclegs
