// core/cuda/sort_scan.cu without CUB.

#include "oraclegs/core/cuda/sort_scan.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace oraclegs::cuda {

void SortByKey(const KeyValues& arrays, int bits, Scratch* scratch, cudaStream_t) {
  scratch->Reserve(arrays.n);  // so that allocations are counted as on a device
  const uint32_t mask = bits >= 32 ? ~0u : (1u << bits) - 1;
  std::vector<int64_t> order(static_cast<size_t>(arrays.n));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int64_t a, int64_t b) { return (arrays.keys[a] & mask) < (arrays.keys[b] & mask); });
  for (int64_t i = 0; i < arrays.n; ++i) {
    arrays.sorted_keys[i] = arrays.keys[order[i]];
    arrays.sorted_values[i] = arrays.values[order[i]];
  }
}

void ExclusiveSum(const uint32_t* values, uint32_t* sums, int64_t n, Scratch* scratch, cudaStream_t) {
  scratch->Reserve(n);
  std::exclusive_scan(values, values + n, sums, 0u);
}

}  // namespace oraclegs::cuda
