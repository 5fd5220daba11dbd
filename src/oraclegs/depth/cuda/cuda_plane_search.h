#pragma once

#include <memory>

#include "oraclegs/depth/plane_search.h"

namespace oraclegs::cuda {

/// The search on a GPU; see MakePlaneSearch. Images, maps and silhouettes of a level are kept there from BeginLevel to
/// EndLevel: about 32 bytes a pixel, and 4 more for each channel.
std::unique_ptr<PlaneSearch> MakeCudaPlaneSearch(int index);

}  // namespace oraclegs::cuda
