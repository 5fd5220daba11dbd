#pragma once
// Images in a quarter of the memory, where that costs nothing.

#include <cstdint>

#include "oraclegs/core/buffer.h"

namespace oraclegs {

/// An image as floats, or as bytes that stand for byte / 255. At most one of the two is defined; neither: no image.
struct PackedImage {
  Buffer<float> floats;
  Buffer<uint8_t> bytes;

  bool defined() const { return floats.defined() || bytes.defined(); }
  /// Of memory.
  int64_t size_in_bytes() const { return floats.bytes() + bytes.bytes(); }
  PackedImage To(Device device) const { return {floats.To(device), bytes.To(device)}; }
};

/// An image on the host, of any shape: as bytes when each value is byte / 255 to the bit, as those of an image that was
/// read from a file and not resized are; else the image itself.
PackedImage Packed(const Buffer<float>& image);

}  // namespace oraclegs
