#pragma once

#include <memory>

#include "oraclegs/propose/warp_device.h"

namespace oraclegs::cuda {

/// Samples (8 bytes each) of a new view that are listed at once; about as many as a dozen images of a million pixels
/// have.
inline constexpr int64_t kListedSamples = int64_t{1} << 25;

/// Makes the device that warps on GPU `index`. It keeps the images and their depth there (about 22 bytes a pixel) and
/// warps one view at a time, while other threads fill holes. A view takes another 70 bytes a pixel and the listed
/// samples, at least those of a single pixel. Memory for a view of the images' size is allocated here, since networks
/// that run between two views keep free memory. Throws UsageError when there is no such GPU, OutOfMemory.
std::unique_ptr<WarpDevice> MakeCudaWarpDevice(const WarpSources& sources, int index,
                                               int64_t listed_samples = kListedSamples);

}  // namespace oraclegs::cuda
