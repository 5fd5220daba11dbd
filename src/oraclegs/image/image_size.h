#pragma once

#include <cstdint>
#include <string>

#include "oraclegs/core/error.h"

namespace oraclegs {

inline constexpr int64_t kMaxPicturePixels = int64_t{1} << 28;  ///< 268 megapixels: beyond what cameras take

/// Throws InputError when a picture file's header gives no size, one that is too large, or more than the `possible`
/// pixels that its bytes can hold: memory is reserved only after this.
inline void CheckPictureSize(int64_t width, int64_t height, uint64_t possible, const std::string& file) {
  if (width <= 0 || height <= 0) throw InputError("{}: its header says {} x {} pixels", file, width, height);
  if (width > kMaxPicturePixels || height > kMaxPicturePixels || width * height > kMaxPicturePixels) {
    throw InputError("{}: its header says {} x {} pixels, at most {} million are possible; make it smaller", file,
                     width, height, kMaxPicturePixels / 1000000);
  }
  if (static_cast<uint64_t>(width * height) > possible) {
    throw InputError(
        "{}: its header says {} x {} pixels, more than its bytes can hold; it is incomplete, copy it again", file,
        width, height);
  }
}

}  // namespace oraclegs
