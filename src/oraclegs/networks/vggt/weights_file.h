#pragma once
// Metadata of a file of VGGT's weights, read before any tensor.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/networks/vggt/vggt.h"

namespace oraclegs::vggt {

/// Defaults are VGGT-1B.
struct WeightsFile {
  std::string name = "VGGT-1B";
  Config network;
  int64_t side = 518;  ///< longer side of the images it was trained on, pixels
  std::vector<int64_t> oracle_layers = {0, 22};
  std::vector<double> oracle_weights = {0.25, 0.75};  ///< one weight a layer; they sum to 1
};

/// Reads the metadata: "model" is the name; the sizes of docs/method.md#vggt-files ("embed_dim", "depth", ...) default
/// to VGGT-1B's, since published files have none. Throws InputError that names the file when it is not safetensors or
/// when a size is missing, is no number, or does not fit the others.
WeightsFile ReadWeightsFile(const std::filesystem::path& path);

}  // namespace oraclegs::vggt
