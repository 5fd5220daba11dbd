#pragma once
// The rasterizer of an NVIDIA GPU. Only in builds with CUDA.

#include <memory>

#include "oraclegs/render/render.h"

namespace oraclegs::cuda {

/// All buffers lie on the device, as must those given. Work goes to the default stream, in order: what is returned may
/// be used at once by other work of that stream. timings() and stats() wait for the device. `runs`: as RasterCore's,
/// for tests. Throws UsageError when there is no such device.
std::unique_ptr<Rasterizer> MakeCudaRasterizer(Device device, int runs = 0);

/// Device memory that training takes for a view of so many pixels, to decide before it begins: `pairs` of a Gaussian
/// and a tile depend on the scene. Images are counted in.
int64_t EstimateRasterizerBytes(int64_t gaussians, int64_t pairs, int64_t pixels);

}  // namespace oraclegs::cuda
