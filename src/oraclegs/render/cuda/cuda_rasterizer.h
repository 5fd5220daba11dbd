#pragma once
// The rasteriser of an NVIDIA GPU. Only in builds with CUDA.

#include <memory>

#include "oraclegs/render/render.h"

namespace oraclegs::cuda {

/// All buffers lie on the device, as must those given. Work goes to the default stream, in order: what is returned may
/// be used at once by other work of that stream. timings() and stats() wait for the device. Throws UsageError when
/// there is no such device.
std::unique_ptr<Rasterizer> MakeCudaRasterizer(Device device);

}  // namespace oraclegs::cuda
