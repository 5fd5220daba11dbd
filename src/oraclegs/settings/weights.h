#pragma once
// Where the weights of networks lie.

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/settings/options.h"

namespace oraclegs {

/// Names of networks, as `oraclegs models` has them.
inline constexpr const char* kDepthModel = "depth-anything-v2-small";
inline constexpr const char* kLpipsModel = "lpips-vgg";
/// Of Stable Virtual Camera: the UNet, the autoencoder, the image encoder.
inline constexpr std::array kSevaModels = {"seva", "sd21-vae", "openclip-vith14"};

/// The .safetensors files of a network, sorted: `given`, or those in it when it is a folder; those of the network's
/// folder in $ORACLEGS_MODELS or ~/.cache/oraclegs, or NAME.safetensors there, when nothing is given; none when there
/// are none. Throws InputError naming `given` where it is neither.
std::vector<std::filesystem::path> FindWeights(const std::string& model, const std::filesystem::path& given);

/// The files that --lpips-weights or the models folder gives; none when there are none. Throws as FindWeights.
std::vector<std::filesystem::path> FindLpips(const WeightOptions& options);

/// "`oraclegs models fetch NAME` brings them", for messages.
std::string HowToFetch(const std::string& model);

struct DepthSource {
  DepthPrior prior = DepthPrior::kStereo;
  std::filesystem::path weights;  ///< of the network, where one takes part

  bool HasNetwork() const { return !weights.empty(); }
};

/// What --depth-prior asks for. Throws InputError when it needs weights that are not there, or finds several files of
/// them.
DepthSource ChooseDepthSource(const RunOptions& options);

}  // namespace oraclegs
