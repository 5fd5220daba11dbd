#pragma once
// The part of a safetensors file in front of its numbers: the types of elements, and the header.

#include <cstdint>
#include <map>
#include <optional>
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

}  // namespace oraclegs
