#pragma once
// Files of the networks' weights.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/safetensors.h"
#include "oraclegs/scene/sensor_files.h"
#include "oraclegs/settings/options.h"

namespace oraclegs {

/// Names of networks in `oraclegs models`.
inline constexpr const char* kDepthModel = "depth-anything-v2-small";
inline constexpr const char* kLpipsModel = "lpips-vgg";
inline constexpr const char* kKeypointModel = "aliked-n16";

/// The .safetensors files of a network, sorted: `given`, or those in it when it is a folder. Without `given`:
/// NAME.safetensors or the files of the network's folder, in $ORACLEGS_MODELS or ~/.cache/oraclegs; empty when there
/// are none. Throws InputError naming `given` where it is neither.
std::vector<std::filesystem::path> FindWeights(const std::string& model, const std::filesystem::path& given);

/// Files of LPIPS from --lpips-weights or the models folder; empty when there are none. Throws as FindWeights.
std::vector<std::filesystem::path> FindLpips(const WeightOptions& options);

/// Bytes of all tensors of a file.
int64_t BytesOf(const SafetensorsFile& file);

/// The file of ALIKED in the models folder; empty where it is not, or where this build has no networks.
std::filesystem::path FindKeypointWeights();

/// "`oraclegs models fetch NAME` brings them", for messages.
std::string HowToFetch(const std::string& model);

struct DepthSource {
  DepthPrior prior = DepthPrior::kStereo;
  std::filesystem::path weights;  ///< weights of the network; empty = none is used

  bool HasNetwork() const { return !weights.empty(); }
};

/// Source for --depth-prior; auto takes the sensor of kMost. Throws InputError when it needs weights or a sensor's
/// depth that are missing, or finds several files.
DepthSource ChooseDepthSource(const RunOptions& options, SensorDepth sensor = SensorDepth::kNone);

}  // namespace oraclegs
