#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace oraclegs {

/// Weights of VGGT that a run uses.
struct VggtWeights {
  std::filesystem::path path;
  std::string name;         ///< name of the network, "VGGT-1B"
  std::string fingerprint;  ///< fingerprint of the content, from a sample of each tensor
  bool commercial = false;  ///< false: its license forbids commercial use
  int64_t bytes = 0;        ///< of all tensors
  int64_t layers = 0;       ///< number of blocks of global attention; 0 = the file has none under the network's names
};

/// Weights in `given` (--vggt-weights), or else those fetched by `oraclegs models fetch`, vggt-commercial before vggt.
/// nullopt when there are none. Throws InputError when `given` does not exist or is no safetensors file.
std::optional<VggtWeights> FindVggtWeights(const std::filesystem::path& given);

/// Weights that are required: throws InputError that says what `needs` them and which command fetches them.
VggtWeights RequireVggtWeights(const std::filesystem::path& given, const std::string& needs);

}  // namespace oraclegs
