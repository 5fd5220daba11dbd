#pragma once
// The small VGGT of tests/golden: its sizes out of the metadata.

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "networks/fixtures.h"
#include "oraclegs/core/files.h"
#include "oraclegs/networks/vggt/weights_file.h"

namespace oraclegs {

inline constexpr const char* kVggtFixture = "vggt_tiny";

inline std::filesystem::path GoldenVggtPath() { return GoldenDir() / (std::string(kVggtFixture) + ".safetensors"); }

inline VggtConfig GoldenVggtConfig() { return ReadVggtFile(GoldenVggtPath()).network; }

inline Vggt GoldenVggt() {
  FileParameters source = GoldenWeights(kVggtFixture);
  Vggt vggt = LoadVggt(source, GoldenVggtConfig(), {true, true, true});
  source.Finish();
  return vggt;
}

/// The weights of the fixture as a file of their own, under the official names and with its metadata; `change` may
/// alter both.
struct TinyVggtParts {
  std::map<std::string, TensorEntry> tensors;
  std::map<std::string, std::string> metadata;
};
inline std::filesystem::path WriteTinyVggt(
    const std::filesystem::path& path, const std::function<void(TinyVggtParts*)>& change = [](TinyVggtParts*) {}) {
  const SafetensorsFile golden = OpenGolden(kVggtFixture);
  const std::string prefix = "weights.";
  TinyVggtParts parts{{}, golden.metadata()};
  for (const auto& [name, entry] : golden.tensors()) {
    if (name.starts_with(prefix)) parts.tensors[name.substr(prefix.size())] = entry;
  }
  change(&parts);
  WriteFileAtomically(path, SerializeSafetensors(parts.tensors, parts.metadata));
  return path;
}

inline PatchGrid GoldenGrid(const SafetensorsFile& file) {
  const int64_t patch = Count(file, "patch_size");
  return {Count(file, "height") / patch, Count(file, "width") / patch};
}

inline std::vector<int64_t> OracleLayers(const SafetensorsFile& file) {
  std::vector<int64_t> layers;
  for (const double layer : Numbers(file, "oracle_layers")) layers.push_back(static_cast<int64_t>(layer));
  return layers;
}

}  // namespace oraclegs
