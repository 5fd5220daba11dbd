#pragma once
// The container of SPZ files: version 1 to 3 are gzip around a header and the attributes, or these alone; version 4 is
// a larger header, a table, and a zstd frame for each attribute.

#include <cstdint>
#include <string>
#include <string_view>

namespace oraclegs {

inline constexpr uint32_t kSpzMagic = 0x5053474e;  // "NGSP"
inline constexpr size_t kSpzHeader = 16;           // bytes, of versions 1 to 3
inline constexpr int kMaxFractionalBits = 23;

/// Where each attribute begins, for n Gaussians, counted from the first one.
struct SpzLayout {
  SpzLayout(uint64_t n, int degree, uint32_t version);

  uint64_t position_bytes, rotation_bytes, sh_bytes;  ///< bytes of one Gaussian
  uint64_t alphas, colors, scales, rotations, sh, end;
};

struct SpzContent {
  uint32_t version = 0, count = 0;
  int degree = 0, fractional_bits = 0;
  bool antialiased = false;
  bool extended = false;   ///< it has records of extensions, which are not read
  std::string attributes;  ///< as SpzLayout says
};

/// The bytes of a file of version 2 to 4. Throws RunError where zstd fails.
std::string PackSpz(const SpzContent& content);

/// Throws InputError naming `file`: no SPZ or one of another version, lengths that do not fit, more than 4 MiB that
/// were packed to less than 1/200, no Gaussians.
SpzContent UnpackSpz(std::string_view bytes, const std::string& file);

}  // namespace oraclegs
