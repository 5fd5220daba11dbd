#pragma once
// Cameras and a first cloud in one pass over all images (docs/method.md#vggt-cameras-and-cloud).

#include "oraclegs/core/progress.h"
#include "oraclegs/networks/networks.h"

namespace oraclegs::vggt {

/// See Networks::EstimatePoses.
PoseEstimate EstimatePoses(const PoseRequest& request, const Listener& listener);

/// Throws RunError when the `needed` bytes for so many images exceed `available`; 0 = unknown.
void RequirePoseMemory(size_t images, int64_t needed, uint64_t available);

}  // namespace oraclegs::vggt
