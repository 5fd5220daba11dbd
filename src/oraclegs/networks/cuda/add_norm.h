#pragma once
// Sums of rows and the layer norm of the sum, in one pass over memory.

#include <cuda_runtime.h>

#include <cstdint>

namespace oraclegs::cuda {

/// Largest width that AddNorm takes; widths are even.
inline constexpr int kAddNormWidth = 1280;

/// sum = x + added + the vector of the row's group; normed = layer norm of that sum. Pointers are to bfloat16 bits in
/// device memory. It computes in float32, the norm from the sum before rounding.
struct AddNorm {
  int64_t rows = 0;
  int width = 0;
  const uint16_t* x = nullptr;        ///< [rows, width]
  const uint16_t* added = nullptr;    ///< [rows, width]; null: nothing
  const uint16_t* vectors = nullptr;  ///< [rows / rows_a_vector, width]; null: nothing
  int64_t rows_a_vector = 1;
  uint16_t* sum = nullptr;                            ///< receives [rows, width]; may be x; null: not wanted
  const uint16_t *weight = nullptr, *bias = nullptr;  ///< [width]
  float eps = 0;
  uint16_t* normed = nullptr;  ///< receives [rows, width]; null: not wanted
};
/// Queues the work.
void RunAddNorm(const AddNorm& in, cudaStream_t stream);

}  // namespace oraclegs::cuda
