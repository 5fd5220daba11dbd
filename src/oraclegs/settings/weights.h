#pragma once
// Files of the networks' weights.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/settings/options.h"

namespace oraclegs {

/// Names of networks in `oraclegs models`.
inline constexpr const char* kDepthModel = "depth-anything-v2-small";
inline constexpr const char* kLpipsModel = "lpips-vgg";

/// The .safetensors files of a network, sorted: `given`, or those in it when it is a folder. Without `given`:
/// NAME.safetensors or the files of the network's folder, in $ORACLEGS_MODELS or ~/.cache/oraclegs; empty when there
/// are none. Throws InputError naming `given` where it is neither.
std::vector<std::filesystem::path> FindWeights(const std::string& model, const std::filesystem::path& given);

/// Files of LPIPS from --lpips-weights or the models folder; empty when there are none. Throws as FindWeights.
std::vector<std::filesystem::path> FindLpips(const WeightOptions& options);

/// "`oraclegs models fetch NAME` brings them", for messages.
std::string HowToFetch(const std::string& model);

struct DepthSource {
  DepthPrior prior = DepthPrior::kStereo;
  std::filesystem::path weights;  ///< weights of the network; empty = none is used

  bool HasNetwork() const { return !weights.empty(); }
};

/// Source for --depth-prior. Throws InputError when it needs weights that are missing, or finds several files.
DepthSource ChooseDepthSource(const RunOptions& options);

/// Weights of VGGT that a run uses.
struct VggtWeights {
  std::filesystem::path path;
  std::string name;         ///< name of the network, "VGGT-1B"
  std::string fingerprint;  ///< fingerprint of the content, from a sample of each tensor
  bool commercial = false;  ///< false: its license forbids commercial use
  int64_t layers = 0;       ///< number of blocks of global attention; 0 = the file has none under the network's names
};

/// Weights in `given` (--vggt-weights), or else those fetched by `oraclegs models fetch`, vggt-commercial before vggt.
/// nullopt when there are none. Throws InputError when `given` does not exist or is no safetensors file.
std::optional<VggtWeights> FindVggtWeights(const std::filesystem::path& given);

/// Weights that are required: throws InputError that says what `needs` them and which command fetches them.
VggtWeights RequireVggtWeights(const std::filesystem::path& given, const std::string& needs);

}  // namespace oraclegs
