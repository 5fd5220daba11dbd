#pragma once
// Pictures in a quarter of the memory, where that costs nothing.

#include "oraclegs/core/buffer.h"

namespace oraclegs {

/// float32 on the CPU, any shape: as bytes (value * 255) when each value is byte / 255 to the bit, as those of a
/// picture that was read from a file and not resized are; else itself. Undefined stays undefined.
Buffer<float> Packed(const Buffer<float>& picture);

}  // namespace oraclegs
