#pragma once
// Files of networks that come in several sizes: which one it is, told by the shapes of a few tensors.

#include <filesystem>
#include <vector>

#include "oraclegs/networks/depth_anything/depth_anything.h"
#include "oraclegs/networks/lpips/lpips.h"

namespace oraclegs {

/// S, B, L, or any other that keeps their rules: heads of 64, the head reads after each quarter of the blocks (of 24
/// blocks after 4, 11, 17 and 23), the input has the size that positions are stored for. Throws InputError for a file
/// that is none.
DepthAnythingConfig RecognizeDepthAnything(const std::filesystem::path& path);
/// Loads it. Throws InputError, also one that lists all that does not fit.
DepthAnything LoadRecognizedDepthAnything(const std::filesystem::path& path, torch::Device device = torch::kCPU);

/// LPIPS with VGG16 or AlexNet, of any widths, whose tensors stand in these files. Throws InputError.
FeatureStackConfig RecognizeLpips(const std::vector<std::filesystem::path>& paths);
Lpips LoadRecognizedLpips(const std::vector<std::filesystem::path>& paths, torch::Device device = torch::kCPU);

}  // namespace oraclegs
