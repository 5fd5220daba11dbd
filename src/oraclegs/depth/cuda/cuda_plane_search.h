#pragma once

#include <memory>

#include "oraclegs/depth/plane_search.h"

namespace oraclegs::cuda {

/// Makes the search on a GPU; see MakePlaneSearch. From BeginLevel to EndLevel the GPU holds the images, maps and
/// silhouettes of a level: about 32 bytes a pixel, and 4 more for each channel.
std::unique_ptr<PlaneSearch> MakeCudaPlaneSearch(int index);

}  // namespace oraclegs::cuda
