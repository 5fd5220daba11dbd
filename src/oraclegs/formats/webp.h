#pragma once
// Arrays of bytes as WebP images, four bytes a pixel.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace oraclegs {

struct ByteImage {
  int width = 0, height = 0;    ///< pixels
  std::vector<uint8_t> rgba{};  ///< height * width * 4, rows from above
};

/// Lossless, with the colors of transparent pixels too. Throws RunError: larger than 16383 pixels a side, memory.
std::string EncodeWebp(const ByteImage& image);

/// `name` stands in errors. Throws InputError: no WebP image, more than `max_pixels` (known before memory is taken).
ByteImage DecodeWebp(std::string_view bytes, int64_t max_pixels, const std::string& name);

}  // namespace oraclegs
