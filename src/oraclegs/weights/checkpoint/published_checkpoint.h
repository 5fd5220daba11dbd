#pragma once
// Published weights of any kind as named tensors: PyTorch's files, safetensors, and either in several parts.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "oraclegs/weights/checkpoint/state_dict.h"

namespace oraclegs {

struct PublishedCheckpoint {
  StateDict tensors;                                ///< without the names that wrappers add
  uint64_t bytes = 0;                               ///< size of the file, or of its parts
  std::vector<std::shared_ptr<const void>> mapped;  ///< what the tensors lie in
};

/// Reads the file by what it begins with, whatever its name; *.safetensors.index.json and *.bin.index.json stand for
/// the parts that they list. `key` as in FindStateDict. No number is read. Throws InputError.
PublishedCheckpoint ReadPublishedCheckpoint(const std::filesystem::path& path, const std::string& key);

}  // namespace oraclegs
