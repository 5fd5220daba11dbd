#pragma once
// Vector quantization: many numbers as indices of few.

#include <cstdint>
#include <vector>

#include "oraclegs/core/buffer.h"

namespace oraclegs {

/// 256 values, rising, that lie near all of `values` in the least squares (Lloyd's algorithm on a histogram). All
/// values are finite.
std::vector<float> MakeCodebook(const std::vector<float>& values);

/// The index of the nearest entry.
uint8_t NearestEntry(const std::vector<float>& codebook, float value);

struct Palette {
  Buffer<float> colors;          ///< [K, D]
  std::vector<uint16_t> labels;  ///< [N]: the row that stands for each vector
};

/// At most `size` (1..65536) vectors that stand for all rows of `vectors` [N, D], by k-means in two levels; rows of
/// more weight are met better. The result does not depend on the number of threads.
Palette MakePalette(const Buffer<float>& vectors, const std::vector<float>& weights, int size);

}  // namespace oraclegs
