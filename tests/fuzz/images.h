#pragma once
// For decoders of images: which headers are worth to go on with.

#include <cstdint>

#include "fuzz/fuzz.h"

namespace oraclegs::fuzz {

/// Pixels up to which images are decoded. Larger ones differ in time and memory alone, which CheckImageSize bounds.
inline constexpr int64_t kSmallPixels = 1 << 16;

/// Whether `read` returns a size that is no larger; errors of the input are allowed.
template <class Read>
bool IsSmall(const Read& read) {
  int width = 0, height = 0;
  Try([&] { read(&width, &height); });
  return width > 0 && height > 0 && int64_t{width} * height <= kSmallPixels;
}

}  // namespace oraclegs::fuzz
