#pragma once
// Rotary position embedding over two axes (docs/method.md#rotary-positions).

#include "oraclegs/networks/common/tensor.h"

namespace oraclegs {

/// Cosines and sines for each token of a sequence: [tokens, 2 (y, x), 1, width / 4].
struct RopeTable {
  Tensor cos, sin;
};

/// Layout of one view's tokens, from which their positions follow.
struct RopeGrid {
  int64_t special = 0;         ///< tokens in front, at position (0, 0): not rotated
  int64_t rows = 0, cols = 0;  ///< grid of patches, row-major; patch (r, c) is at (r + 1, c + 1)
};

/// `width` is that of a head, a multiple of 4 (ShapeError otherwise); frequencies are base^(-4 j / width).
RopeTable MakeRopeTable(const RopeGrid& grid, int64_t width, double base);
/// Tables of `views` views, one after the other.
RopeTable Repeat(const RopeTable& table, int64_t views);
/// t [B, heads, tokens, width]: the first half of each vector is rotated by y, the second by x; entry j of a half pairs
/// with entry j + width / 4.
Tensor Rotate(const RopeTable& table, const Tensor& t);

}  // namespace oraclegs
