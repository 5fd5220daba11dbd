#pragma once

#include <memory>

#include "oraclegs/propose/warp_device.h"

namespace oraclegs::cuda {

/// Samples (8 bytes each) of a new view that are listed at once; a dozen images of a million pixels have about as
/// many.
inline constexpr int64_t kListedSamples = int64_t{1} << 25;

/// Keeps the images and what is known of them on GPU `index` (about 22 bytes a pixel), and warps there; one view
/// at a time, while other threads fill holes. A view takes another 70 bytes a pixel and the listed samples, or as many
/// as a single pixel has; memory for a view of the images' size is allocated here, since networks that run
/// between two views keep what was free. Throws UsageError when there is no such GPU, OutOfMemory.
std::unique_ptr<WarpDevice> MakeCudaWarpDevice(const WarpSources& sources, int index,
                                               int64_t listed_samples = kListedSamples);

}  // namespace oraclegs::cuda
