#pragma once

#include <vector>

#include "oraclegs/core/buffer.h"

namespace oraclegs {

/// One float32 image at a time, of any of the shapes a run works on, in a storage that grows to the largest. A handle
/// is made the first time its shape is asked for and kept, so that from then on nothing is allocated.
class ImageBuffer {
 public:
  /// `purpose`, a plural, stands in the error when memory ends.
  explicit ImageBuffer(Device device = kCpu, const char* purpose = "the images") : device_(device), purpose_(purpose) {}

  /// A buffer of this shape on the device, holding anything. All buffers of one ImageBuffer share their memory: it is
  /// to be used until the next Get.
  const Buffer<float>& Get(const Shape& shape);

 private:
  Device device_;
  const char* purpose_;
  Buffer<float> storage_;             // [count]
  std::vector<Buffer<float>> views_;  // into storage_, of different shapes
};

}  // namespace oraclegs
