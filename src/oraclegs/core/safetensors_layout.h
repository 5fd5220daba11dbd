#pragma once
// The part of a safetensors file in front of its numbers: the types of elements, and the header.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace oraclegs {

/// Bytes of one element ("F32": 4); nothing for a type that the format does not have.
std::optional<uint64_t> ElementBytes(const std::string& dtype);

/// Bytes of a tensor: the product of its sizes and of one element's bytes; nothing when that is more than an int64_t
/// holds or a size is negative.
std::optional<uint64_t> TensorBytes(const std::vector<int64_t>& shape, uint64_t element_bytes);

struct TensorLayout {
  std::string dtype;
  std::vector<int64_t> shape;
};

/// The beginning of a file, and the tensors whose bytes follow it.
struct SafetensorsLayout {
  std::string beginning;           ///< length of the header and the header
  std::vector<std::string> order;  ///< widest elements first, then by name: each is aligned to its element, no gaps
  uint64_t data_bytes = 0;         ///< bytes of all tensors
};

/// Throws std::logic_error for a type that the format does not have, a negative size, a name that is not UTF-8 or that
/// the format keeps for itself, and more bytes than an int64_t holds.
SafetensorsLayout LayOutSafetensors(const std::map<std::string, TensorLayout>& tensors,
                                    const std::map<std::string, std::string>& metadata);

// NAME.safetensors.index.json: one set of tensors in several files, as large models are published. {"metadata": {...},
// "weight_map": {"tensor": "NAME-00001-of-00002.safetensors", ...}}; the parts lie beside it.

/// True for names that end in ".safetensors.index.json".
bool IsShardIndex(const std::filesystem::path& path);
/// True for names that end in ".bin.index.json": the parts are files of PyTorch.
bool IsTorchShardIndex(const std::filesystem::path& path);

/// The parts by file name, and the tensors of each. Throws InputError when the index cannot be read, is malformed or
/// empty, or names a part that is no *.safetensors (or *.bin) file beside it: an index must not reach into other
/// folders.
std::map<std::string, std::set<std::string>> ReadShardIndex(const std::filesystem::path& path);

}  // namespace oraclegs
