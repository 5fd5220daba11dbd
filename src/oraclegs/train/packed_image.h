#pragma once
// Images in a quarter of the memory where bytes hold them exactly.

#include <cstdint>

#include "oraclegs/core/buffer.h"

namespace oraclegs {

/// An image as floats, or as bytes that stand for byte / 255. At most one of the two is defined; neither = no image.
struct PackedImage {
  Buffer<float> floats;
  Buffer<uint8_t> bytes;

  bool defined() const { return floats.defined() || bytes.defined(); }
  /// Bytes of memory that it takes.
  int64_t size_in_bytes() const { return floats.bytes() + bytes.bytes(); }
  PackedImage To(Device device) const { return {floats.To(device), bytes.To(device)}; }
};

/// Packs an image on the host, of any shape: as bytes when each value is byte / 255 to the bit, as in an image file
/// that was not resized; else as the image itself.
PackedImage Packed(const Buffer<float>& image);

}  // namespace oraclegs
