#pragma once
// The safetensors container: 8-byte little-endian header length, JSON header, raw little-endian tensors. Torch-free.

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace oraclegs {

/// One tensor of a file: dtype as the format spells it ("F32", "F64", "I32", "I64", "U8", "F16", "BF16", ...).
struct TensorEntry {
  std::string dtype;
  std::vector<int64_t> shape;
  std::string_view bytes;  ///< row-major, little-endian; valid as long as the SafetensorsFile lives

  int64_t numel() const;
};

/// A file opened for reading. Every offset, length and product of sizes is checked against the file before use.
class SafetensorsFile {
 public:
  /// Memory-maps `path`. A path that ends in ".safetensors.index.json" stands for the parts it lists, which are read as
  /// one file (core/safetensors_layout.h). Throws InputError naming it and what is wrong.
  static SafetensorsFile Open(const std::filesystem::path& path);
  /// Parses bytes already in memory; `name` stands for the file in errors.
  static SafetensorsFile Parse(std::string bytes, const std::string& name);

  const std::map<std::string, TensorEntry>& tensors() const { return tensors_; }
  const std::map<std::string, std::string>& metadata() const { return metadata_; }
  bool Has(const std::string& name) const { return tensors_.count(name) > 0; }
  /// Throws InputError naming the file and the missing tensor.
  const TensorEntry& Get(const std::string& name) const;
  /// The values converted from F32, F64, F16, BF16, I32, I64 or U8 to float, double, int32_t, int64_t or uint8_t.
  /// Throws InputError for another dtype and for a number that an integer T cannot hold.
  template <class T>
  std::vector<T> Values(const std::string& name) const;

 private:
  static SafetensorsFile OpenShards(const std::filesystem::path& index_path);
  void ParseHeader(std::string_view bytes);

  std::string name_;
  std::shared_ptr<const void> storage_;
  std::map<std::string, TensorEntry> tensors_;
  std::map<std::string, std::string> metadata_;
};

/// Serializes tensors (widest elements first, then by name, so that each is aligned to its element without a gap) and
/// metadata. Throws std::logic_error when an entry's byte count disagrees with its shape.
std::string SerializeSafetensors(const std::map<std::string, TensorEntry>& tensors,
                                 const std::map<std::string, std::string>& metadata);

}  // namespace oraclegs
