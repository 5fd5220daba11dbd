#pragma once
// What a file of VGGT's weights says of itself, before a tensor is read.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/networks/vggt/vggt.h"

namespace oraclegs::vggt {

/// The defaults are VGGT-1B.
struct WeightsFile {
  std::string name = "VGGT-1B";
  Config network;
  int64_t side = 518;  ///< longer side of the images it was trained on, pixels
  std::vector<int64_t> oracle_layers = {0, 22};
  std::vector<double> oracle_weights = {0.25, 0.75};  ///< of these layers; they sum to 1
};

/// The metadata "model" is the name; the sizes are those of docs/method.md#vggt-files ("embed_dim", "depth", ...) where
/// the file has them, else VGGT-1B's: published files have none. Throws InputError naming the file: not safetensors, a
/// size that is missing, no number, or does not fit the others.
WeightsFile ReadWeightsFile(const std::filesystem::path& path);

}  // namespace oraclegs::vggt
