#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace oraclegs {

/// The weights of VGGT that a run uses.
struct VggtWeights {
  std::filesystem::path path;
  std::string name;         ///< of the network, "VGGT-1B"
  std::string fingerprint;  ///< of its content, by a sample of each tensor
  bool commercial = false;  ///< false: its license forbids commercial use
  int64_t layers = 0;       ///< of global attention; 0 = the file has none under the network's names
};

/// `given` (--vggt-weights), or else what `oraclegs models fetch` left: of vggt-commercial, of vggt. Nothing when none
/// is there. Throws InputError when `given` does not exist or is no safetensors file.
std::optional<VggtWeights> FindVggtWeights(const std::filesystem::path& given);

/// The same where they are needed: throws InputError that says what `needs` them and which command brings them.
VggtWeights RequireVggtWeights(const std::filesystem::path& given, const std::string& needs);

}  // namespace oraclegs
