#pragma once

#include <initializer_list>
#include <vector>

#include "oraclegs/core/buffer.h"

namespace oraclegs {

/// One float32 image at a time, of any of the shapes a run works on, in a storage that grows to the largest. A tensor
/// is made the first time its shape is asked for and kept, so that from then on nothing is allocated.
class ImageBuffer {
 public:
  explicit ImageBuffer(Device device = kCpu) : device_(device) {}

  /// A contiguous tensor of this shape on the device, holding anything. All tensors of one buffer share their memory:
  /// it is to be used until the next Get.
  const Buffer<float>& Get(std::initializer_list<int64_t> shape);

 private:
  Device device_;
  Buffer<float> storage_;             // [count]
  std::vector<Buffer<float>> views_;  // into storage_, of different shapes
};

}  // namespace oraclegs
