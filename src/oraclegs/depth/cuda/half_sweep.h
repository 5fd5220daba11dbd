#pragma once
// PatchMatch on a GPU: the pixels of one color of the red-black pattern, in one iteration (depth/search_math.h).

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/depth/search_math.h"

namespace oraclegs::cuda {

/// A GatherImage in device memory, one channel after the other.
struct SweepImage {
  const uint32_t* words = nullptr;
  int width = 0, height = 0;
};

/// Input of RunHalfSweep; all pointers are to device memory. 1.2 KB, passed as the kernel's argument.
struct HalfSweep {
  SearchView view;
  SweepImage image;                 ///< image of the searched view
  SweepImage sources[kMaxSources];  ///< images of view.sources
  int channels = 1;                 ///< channels of all images; 1 or 3
  int iteration = 0;
  int color = 0;  ///< pixels with (x + y) % 2 == color
};

/// Queues one launch: writes planes and costs of the pixels of this color, reads those of the other.
void RunHalfSweep(const HalfSweep& sweep, cudaStream_t stream);

}  // namespace oraclegs::cuda
