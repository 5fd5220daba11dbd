#include "oraclegs/core/cuda/sort_scan.h"

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

namespace oraclegs::cuda {
namespace {

/// CUB's two calls: how much memory, then the work.
template <class Call>
void CallCub(const char* what, Scratch* scratch, const Call& call) {
  size_t bytes = 0;
  Check(call(nullptr, bytes), what);
  scratch->Reserve(static_cast<int64_t>(bytes > 0 ? bytes : 1));
  Check(call(scratch->data(), bytes), what);
}

}  // namespace

void SortByKey(const KeyValues& arrays, int bits, Scratch* scratch, cudaStream_t stream) {
  if (arrays.n == 0) return;
  CallCub("sorting on the GPU", scratch, [&](void* memory, size_t& bytes) {
    return cub::DeviceRadixSort::SortPairs(memory, bytes, arrays.keys, arrays.sorted_keys, arrays.values,
                                           arrays.sorted_values, arrays.n, 0, bits, stream);
  });
}

void ExclusiveSum(const uint32_t* values, uint32_t* sums, int64_t n, Scratch* scratch, cudaStream_t stream) {
  if (n == 0) return;
  CallCub("summing on the GPU", scratch, [&](void* memory, size_t& bytes) {
    return cub::DeviceScan::ExclusiveSum(memory, bytes, values, sums, n, stream);
  });
}

}  // namespace oraclegs::cuda
