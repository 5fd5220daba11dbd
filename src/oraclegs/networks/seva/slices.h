#pragma once
// Wide activations in slices: a layer that works row by row needs no memory for all rows at once.

#include <algorithm>

#include "oraclegs/networks/common/tensor.h"

namespace oraclegs::seva {

/// Numbers in the widest activation of a slice: few enough for the caches of a CPU, enough to keep a GPU busy.
inline constexpr int64_t kSliceOnCpu = int64_t{1} << 22;
inline constexpr int64_t kSliceOnGpu = int64_t{1} << 27;

/// Rows of a slice, at least one, when the widest activation has `numbers_per_row`. Depends on sizes only.
inline int64_t RowsAtOnce(const Tensor& x, int64_t numbers_per_row) {
  const int64_t budget = x.is_cuda() ? kSliceOnGpu : kSliceOnCpu;
  return std::max<int64_t>(1, budget / std::max<int64_t>(numbers_per_row, 1));
}

}  // namespace oraclegs::seva
