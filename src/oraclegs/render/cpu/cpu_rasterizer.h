#pragma once

#include <memory>

#include "oraclegs/render/render.h"

namespace oraclegs::cpu {

std::unique_ptr<Rasterizer> MakeCpuRasterizer();

}  // namespace oraclegs::cpu
