#pragma once

#include <memory>

#include "oraclegs/core/device.h"
#include "oraclegs/propose/warp_device.h"

namespace oraclegs {

/// Makes the warp device of that name; `sources` must outlive it. On a GPU, which becomes the current one, it keeps a
/// copy of all images. Throws UsageError for a device this build cannot use, OutOfMemory.
std::unique_ptr<WarpDevice> MakeWarpDevice(Device device, const WarpSources& sources);

}  // namespace oraclegs
