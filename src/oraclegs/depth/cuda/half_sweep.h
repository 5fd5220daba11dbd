#pragma once
// PatchMatch on a GPU: the pixels of one colour of the chessboard, in one iteration (depth/search_math.h).

#include <cuda_runtime.h>

#include <cstdint>

#include "oraclegs/depth/search_math.h"

namespace oraclegs::cuda {

/// A PackedImage in the device's memory, one channel after the other.
struct DevicePicture {
  const uint32_t* words = nullptr;
  int width = 0, height = 0;
};

/// All pointers are to the device's memory. Handed to the kernel as it is: 1.2 KB of its arguments.
struct HalfSweep {
  SearchView view;
  DevicePicture picture;               ///< of the view
  DevicePicture sources[kMaxSources];  ///< of view.sources
  int channels = 1;                    ///< of all pictures; 1 or 3
  int iteration = 0;
  int color = 0;  ///< pixels with (x + y) % 2 == color
};

/// Queues one launch, which writes planes and costs of the pixels of this colour and reads those of the other.
void RunHalfSweep(const HalfSweep& sweep, cudaStream_t stream);

}  // namespace oraclegs::cuda
