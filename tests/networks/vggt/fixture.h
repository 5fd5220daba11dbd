#pragma once
// The small VGGT of tests/golden: its sizes out of the metadata.

#include <filesystem>
#include <string>
#include <vector>

#include "networks/fixtures.h"
#include "oraclegs/networks/vggt/weights_file.h"
#include "support/network_files.h"

namespace oraclegs::vggt {

inline constexpr const char* kVggtFixture = "vggt_tiny";

inline std::filesystem::path GoldenVggtPath() { return GoldenDir() / (std::string(kVggtFixture) + ".safetensors"); }

inline Config GoldenVggtConfig() { return ReadWeightsFile(GoldenVggtPath()).network; }

inline Vggt GoldenVggt() {
  FileParameters source = GoldenWeights(kVggtFixture, {"point_head."});
  Vggt vggt = LoadVggt(source, GoldenVggtConfig(), {true, true});
  source.Finish();
  return vggt;
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

}  // namespace oraclegs::vggt
