#pragma once
// ALIKED [Zhao 2023]: keypoints of an image and what they look like (docs/method.md#aliked).

#include <filesystem>
#include <memory>

#include "oraclegs/networks/aliked/descriptors.h"
#include "oraclegs/networks/aliked/encoder.h"
#include "oraclegs/networks/networks.h"

namespace oraclegs::aliked {

struct Aliked {
  Encoder encoder;
  DescriptorHead head;
};
/// Tensor names are those of the published files.
Aliked LoadAliked(ParameterSource& source, const AlikedConfig& config);

/// Widths and number of samples of a weights file. Throws InputError for a file of another network.
AlikedConfig RecognizeAliked(const std::filesystem::path& path);
/// Loads what RecognizeAliked finds. Throws InputError that lists all that does not fit.
Aliked LoadRecognizedAliked(const std::filesystem::path& path, torch::Device device = torch::kCPU);

/// Keypoints in the pixels of rgb [height, width, 3] float32 in [0, 1]. options.max_side is not looked at. Throws
/// ShapeError.
ImageFeatures FindFeatures(const Aliked& network, const Tensor& rgb, const KeypointOptions& options);

/// Loads ALIKED behind the program's interface. Throws InputError.
std::unique_ptr<KeypointNetwork> LoadKeypointNetwork(const std::filesystem::path& path, torch::Device device);

}  // namespace oraclegs::aliked
