#pragma once
// Gaussians and cameras that gpu_bench trains on.

#include <filesystem>
#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

struct GpuScene {
  Gaussians gaussians;          ///< on the CPU
  std::vector<Camera> cameras;  ///< at least one
};

/// Seeded Gaussians in front of three cameras side by side. Every pixel is opaque after some sixty Gaussians.
GpuScene SyntheticScene(int64_t gaussians, int width, int height);

/// A trained model, seen from the first three frames of a transforms.json (images are not needed), at the size with
/// about as many pixels. Throws InputError.
GpuScene TrainedScene(const std::filesystem::path& ply, const std::filesystem::path& transforms, int64_t pixels);

}  // namespace oraclegs
