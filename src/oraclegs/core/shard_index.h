#pragma once
// NAME.safetensors.index.json: one set of tensors in several files, as large models are published. {"metadata": {...},
// "weight_map": {"tensor": "NAME-00001-of-00002.safetensors", ...}}; the parts lie beside it.

#include <filesystem>
#include <map>
#include <set>
#include <string>

namespace oraclegs {

/// True for names that end in ".safetensors.index.json".
bool IsShardIndex(const std::filesystem::path& path);
/// True for names that end in ".bin.index.json": the parts are files of PyTorch.
bool IsTorchShardIndex(const std::filesystem::path& path);

/// The parts by file name, and the tensors of each. Throws InputError when the index cannot be read, is malformed or
/// empty, or names a part that is no *.safetensors (or *.bin) file beside it: an index must not reach into other
/// folders.
std::map<std::string, std::set<std::string>> ReadShardIndex(const std::filesystem::path& path);

}  // namespace oraclegs
