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

/// All pointers are to device memory. An argument of the kernel as it is: 1.2 KB.
struct HalfSweep {
  SearchView view;
  SweepImage image;                 ///< of the view
  SweepImage sources[kMaxSources];  ///< of view.sources
  int channels = 1;                 ///< of all images; 1 or 3
  int iteration = 0;
  int color = 0;  ///< pixels with (x + y) % 2 == color
};

/// Queues one launch, which writes planes and costs of the pixels of this color and reads those of the other.
void RunHalfSweep(const HalfSweep& sweep, cudaStream_t stream);

}  // namespace oraclegs::cuda
