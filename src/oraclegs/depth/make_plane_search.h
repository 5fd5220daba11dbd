#pragma once

#include <memory>

#include "oraclegs/core/device.h"
#include "oraclegs/depth/plane_search.h"

namespace oraclegs {

/// Makes the search of a device. On the CPU it uses all threads, and any number of them gives the same bits. On a GPU
/// it is the same search with the same random numbers: equal up to rounding, and the same bits on the same GPU. Throws
/// UsageError when there is no such GPU, or the program was built without CUDA; on a GPU BeginLevel throws OutOfMemory.
std::unique_ptr<PlaneSearch> MakePlaneSearch(Device device);

}  // namespace oraclegs
