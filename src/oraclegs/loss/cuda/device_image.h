#pragma once
// Images as kernels read them. Most targets were 8-bit files: kept as bytes they take a quarter of the memory and
// bandwidth without losing a bit.

#include <cmath>
#include <cstdint>

#include "oraclegs/core/device_macros.h"

namespace oraclegs::cuda {

/// Values in [0, 1], row by row, channels interleaved: 32-bit floats, or bytes that stand for byte / 255. Null: there
/// is no such image.
struct DeviceImage {
  const void* data = nullptr;
  bool packed = false;  ///< bytes

  ORACLEGS_HD inline bool is_there() const { return data != nullptr; }
  ORACLEGS_HD inline float At(int64_t i) const {
    if (!packed) return static_cast<const float*>(data)[i];
    // Divides by 255 in three instructions, to the bit as the reader of files does.
    const float byte = static_cast<float>(static_cast<const uint8_t*>(data)[i]), near = byte * (1.f / 255);
    return fmaf(fmaf(-255.f, near, byte), 1.f / 255, near);
  }
};

}  // namespace oraclegs::cuda
