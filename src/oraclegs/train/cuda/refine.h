#pragma once
// Relocation and growth of 3DGS-MCMC on a GPU, without transfers (docs/method.md#mcmc-relocation). The CPU's is
// train/mcmc.h. Draws equal the CPU's, except where a number falls within 1e-9 of the border between two Gaussians:
// opacities are weighed as whole multiples of 2^-36, so that their running sums are exact and the same in every run.

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/train/constants.h"
#include "oraclegs/train/step_constants.h"

namespace oraclegs::cuda {

/// Scratch for n Gaussians, in device memory.
struct RefineScratch {
  uint64_t* weights = nullptr;     ///< [n]
  uint64_t* ranks = nullptr;       ///< [n]
  uint64_t* totals = nullptr;      ///< [RefineBlocks(n)]
  int* sources = nullptr;          ///< [n]
  int* draws = nullptr;            ///< [n]
  const double* choose = nullptr;  ///< [kMaxCopies + 1][kMaxCopies + 1] C(n, k)
};

inline int64_t RefineBlocks(int64_t n) { return (n + 255) / 256; }

struct RefineInput {
  uint64_t seed = 0;
  int64_t iteration = 0;
  int64_t count = 0;  ///< Gaussians to draw from
  GaussianRows params;
  MomentRows moments;
  RefineScratch scratch;
};

/// Queues relocation (docs/method.md#mcmc-relocation): dead Gaussians move onto living ones drawn by opacity.
void RunRelocate(const RefineInput& in, cudaStream_t stream);

/// Queues the first half of growth: weighs all Gaussians. Afterwards the last of scratch.weights is 0 where there is
/// nothing to draw from.
void RunWeigh(const RefineInput& in, cudaStream_t stream);

/// Queues the second half of growth: rows count ... count + added - 1 of params and moments become copies of Gaussians
/// drawn by opacity, with zero moments. scratch.sources must have room for `added`, too.
void RunGrow(const RefineInput& in, int64_t added, cudaStream_t stream);

}  // namespace oraclegs::cuda
