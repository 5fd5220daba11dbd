#pragma once
// The sorts and sums of CUB behind plain functions: device memory in, device memory out, nothing waits. `scratch` grows
// to the largest use.

#include <cstdint>

#include "oraclegs/core/cuda/device_array.h"

namespace oraclegs::cuda {

using Scratch = DeviceArray<char>;

/// Arrays of n items. Input and output do not overlap; inputs are left as they are.
struct KeyValues {
  const uint32_t *keys, *values;
  uint32_t *sorted_keys, *sorted_values;
  int64_t n;
};

/// Stable, ascending by the lowest `bits` bits of the keys.
void SortByKey(const KeyValues& arrays, int bits, Scratch* scratch, cudaStream_t stream);

/// sums[i] = values[0] + ... + values[i - 1], modulo 2^32.
void ExclusiveSum(const uint32_t* values, uint32_t* sums, int64_t n, Scratch* scratch, cudaStream_t stream);

}  // namespace oraclegs::cuda
