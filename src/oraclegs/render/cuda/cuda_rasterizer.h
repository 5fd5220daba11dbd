#pragma once
// The rasterizer of an NVIDIA GPU. Only in builds with CUDA.

#include <memory>

#include "oraclegs/render/render.h"

namespace oraclegs::cuda {

/// Makes the rasterizer. All buffers are on the device, and those given must be. Work goes to the default stream, in
/// order: results may be used at once by other work of that stream. timings() and stats() wait for the device. `runs`:
/// as RasterCore's, for tests. Throws UsageError when there is no such device.
std::unique_ptr<Rasterizer> MakeCudaRasterizer(Device device, int runs = 0);

/// Estimate of the device memory that training takes for a view of so many pixels, images included, before it begins.
/// `pairs` of a Gaussian and a tile depend on the scene.
int64_t EstimateRasterizerBytes(int64_t gaussians, int64_t pairs, int64_t pixels);

}  // namespace oraclegs::cuda
