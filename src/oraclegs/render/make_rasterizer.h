#pragma once

#include <memory>

#include "oraclegs/render/render.h"

namespace oraclegs {

/// Makes the rasterizer of a device. Throws UsageError when this build has none for it.
std::unique_ptr<Rasterizer> MakeRasterizer(Device device);

}  // namespace oraclegs
