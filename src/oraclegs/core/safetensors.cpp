#include "oraclegs/core/safetensors.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <utility>

#include "oraclegs/core/bfloat16.h"
#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/safetensors_layout.h"
#include "oraclegs/core/unique_json.h"

namespace oraclegs {
namespace {

using nlohmann::json;

constexpr uint64_t kLengthBytes = 8;
constexpr uint64_t kMaxHeaderBytes = 100'000'000;  // the limit of the format's own library
constexpr const char* kMetadataKey = "__metadata__";

std::optional<uint64_t> AsUnsigned(const json& value) {
  if (!value.is_number_unsigned()) return std::nullopt;
  const uint64_t number = value.get<uint64_t>();
  if (number > static_cast<uint64_t>(std::numeric_limits<int64_t>::max())) return std::nullopt;
  return number;
}

struct Extent {
  uint64_t begin = 0, end = 0;
  std::string name;

  bool operator<(const Extent& other) const {
    return std::tie(begin, end, name) < std::tie(other.begin, other.end, other.name);
  }
};

/// Reads {"dtype": ..., "shape": [...], "data_offsets": [begin, end]} and checks it against `data`.
TensorEntry ParseTensor(const json& value, std::string_view data, const std::string& where, Extent* extent) {
  const bool complete = value.is_object() && value.contains("dtype") && value.contains("shape") &&
                        value.contains("data_offsets") && value["dtype"].is_string() && value["shape"].is_array() &&
                        value["data_offsets"].is_array() && value["data_offsets"].size() == 2;
  if (!complete) throw InputError("{} lacks a dtype, a shape or two data_offsets; write the file again", where);
  TensorEntry entry;
  entry.dtype = value["dtype"].get<std::string>();
  const auto element_bytes = ElementBytes(entry.dtype);
  if (!element_bytes) throw InputError("{} has the unknown dtype {}", where, QuotedForMessage(entry.dtype));
  for (const json& size : value["shape"]) {
    const auto number = AsUnsigned(size);
    if (!number) throw InputError("{} has a size in its shape that is no count; write the file again", where);
    entry.shape.push_back(static_cast<int64_t>(*number));
  }
  const auto begin = AsUnsigned(value["data_offsets"][0]), end = AsUnsigned(value["data_offsets"][1]);
  if (!begin || !end || *begin > *end || *end > data.size()) {
    throw InputError("{} lies outside the file's {} data bytes; the file is incomplete, get it again", where,
                     data.size());
  }
  const auto bytes = TensorBytes(entry.shape, *element_bytes);
  if (!bytes || *bytes != *end - *begin) {
    throw InputError("{} has {} bytes, which its shape [{}] of {} disagrees with; write the file again", where,
                     *end - *begin, fmt::join(entry.shape, ", "), entry.dtype);
  }
  entry.bytes = data.substr(*begin, *end - *begin);
  extent->begin = *begin;
  extent->end = *end;
  return entry;
}

template <class T, class From>
bool Represents(From value) {
  if constexpr (std::is_floating_point_v<T>) {
    return true;
  } else if constexpr (std::is_floating_point_v<From>) {
    // 2^digits is exact in every floating type, the largest integer below it often is not.
    const double above = std::ldexp(1.0, std::numeric_limits<T>::digits);
    return value >= static_cast<double>(std::numeric_limits<T>::min()) && value < above;
  } else {
    return std::in_range<T>(value);
  }
}

template <class T, class From>
std::vector<T> Convert(std::string_view bytes, const std::string& where) {
  std::vector<T> values(bytes.size() / sizeof(From));
  for (size_t i = 0; i < values.size(); ++i) {
    From stored;
    std::memcpy(&stored, bytes.data() + i * sizeof(From), sizeof(From));  // a file need not align its tensors
    const auto value = [&] {
      if constexpr (std::is_class_v<From>)
        return static_cast<float>(stored);
      else
        return stored;
    }();
    if (!Represents<T>(value))
      throw InputError("{} holds {} at element {}, where a whole number that fits is needed", where, value, i);
    values[i] = static_cast<T>(value);
  }
  return values;
}

struct BFloat16 {
  uint16_t bits;
  operator float() const { return FromBfloat16(bits); }
};

/// IEEE half precision: 1 sign bit, 5 of exponent, 10 of fraction.
struct Float16 {
  uint16_t bits;
  operator float() const {
    const int exponent = bits >> 10 & 31;
    const float fraction = static_cast<float>(bits & 1023) / 1024;
    const float size = exponent == 31  ? (bits & 1023 ? std::numeric_limits<float>::quiet_NaN()
                                                      : std::numeric_limits<float>::infinity())
                       : exponent == 0 ? std::ldexp(fraction, -14)
                                       : std::ldexp(1 + fraction, exponent - 15);
    return bits >> 15 ? -size : size;
  }
};

}  // namespace

int64_t TensorEntry::numel() const {
  int64_t n = 1;
  for (const int64_t size : shape) n *= size;
  return n;
}

SafetensorsFile SafetensorsFile::Open(const std::filesystem::path& path) {
  if (IsShardIndex(path)) return OpenShards(path);
  SafetensorsFile file;
  file.name_ = path.string();
  const MappedFile mapped = MapFile(path);
  file.storage_ = mapped.owner;
  file.ParseHeader(mapped.bytes);
  return file;
}

SafetensorsFile SafetensorsFile::OpenShards(const std::filesystem::path& index_path) {
  SafetensorsFile whole;
  whole.name_ = index_path.string();
  const auto shards = std::make_shared<std::vector<std::shared_ptr<const void>>>();
  whole.storage_ = shards;
  for (const auto& [shard, names] : ReadShardIndex(index_path)) {
    const auto path = index_path.parent_path() / shard;
    std::error_code unknown;
    if (!std::filesystem::exists(path, unknown)) {
      throw InputError("{}: the part {} is not beside it; get the missing part", whole.name_, QuotedForMessage(shard));
    }
    SafetensorsFile part = Open(path);
    for (const std::string& name : names) whole.tensors_[name] = part.Get(name);
    for (const auto& [name, entry] : part.tensors_) {
      if (!names.count(name)) {
        throw InputError("{}: holds tensor {}, which {} does not seek there; get all parts of one version",
                         path.string(), QuotedForMessage(name), whole.name_);
      }
    }
    whole.metadata_.merge(part.metadata_);
    shards->push_back(std::move(part.storage_));
  }
  return whole;
}

SafetensorsFile SafetensorsFile::Parse(std::string bytes, const std::string& name) {
  SafetensorsFile file;
  file.name_ = name;
  const auto storage = std::make_shared<const std::string>(std::move(bytes));
  file.storage_ = storage;
  file.ParseHeader(*storage);
  return file;
}

void SafetensorsFile::ParseHeader(std::string_view bytes) {
  if (bytes.size() < kLengthBytes) {
    throw InputError("{}: has {} bytes, too few for a safetensors file; get it again", name_, bytes.size());
  }
  uint64_t header_bytes = 0;
  for (uint64_t i = 0; i < kLengthBytes; ++i) {
    header_bytes |= uint64_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
  }
  if (header_bytes > kMaxHeaderBytes || header_bytes > bytes.size() - kLengthBytes) {
    throw InputError("{}: announces a header of {} bytes in a file of {}; it is cut off or no safetensors file", name_,
                     header_bytes, bytes.size());
  }
  const json header = ParseUniqueJson(bytes.substr(kLengthBytes, header_bytes), name_, "header");
  if (!header.is_object()) throw InputError("{}: the header is not a JSON object; get the file again", name_);
  const std::string_view data = bytes.substr(kLengthBytes + header_bytes);
  std::vector<Extent> extents;
  for (const auto& [name, value] : header.items()) {
    if (name == kMetadataKey) {
      if (!value.is_object()) throw InputError("{}: {} is not a JSON object", name_, kMetadataKey);
      for (const auto& [key, text] : value.items()) {
        if (!text.is_string()) throw InputError("{}: metadata {} is not a text", name_, QuotedForMessage(key));
        metadata_[key] = text.get<std::string>();
      }
      continue;
    }
    Extent extent{0, 0, name};
    tensors_[name] = ParseTensor(value, data, fmt::format("{}: tensor {}", name_, QuotedForMessage(name)), &extent);
    extents.push_back(extent);
  }
  // The format has no gaps and no overlaps: each tensor begins where the one before it ends.
  std::sort(extents.begin(), extents.end());
  uint64_t end = 0;
  for (const Extent& extent : extents) {
    if (extent.begin != end) {
      throw InputError("{}: tensor {} begins at data byte {}, expected {}; the file is damaged, get it again", name_,
                       QuotedForMessage(extent.name), extent.begin, end);
    }
    end = extent.end;
  }
  if (end != data.size()) {
    throw InputError("{}: has {} bytes after its last tensor; the file is damaged, get it again", name_,
                     data.size() - end);
  }
}

const TensorEntry& SafetensorsFile::Get(const std::string& name) const {
  const auto it = tensors_.find(name);
  if (it == tensors_.end())
    throw InputError("{}: has no tensor {}; is it the right file?", name_, QuotedForMessage(name));
  return it->second;
}

template <class T>
std::vector<T> SafetensorsFile::Values(const std::string& name) const {
  const TensorEntry& entry = Get(name);
  const std::string where = fmt::format("{}: tensor {}", name_, QuotedForMessage(name));
  if (entry.dtype == "F32") return Convert<T, float>(entry.bytes, where);
  if (entry.dtype == "F64") return Convert<T, double>(entry.bytes, where);
  if (entry.dtype == "F16") return Convert<T, Float16>(entry.bytes, where);
  if (entry.dtype == "BF16") return Convert<T, BFloat16>(entry.bytes, where);
  if (entry.dtype == "I32") return Convert<T, int32_t>(entry.bytes, where);
  if (entry.dtype == "I64") return Convert<T, int64_t>(entry.bytes, where);
  if (entry.dtype == "U8") return Convert<T, uint8_t>(entry.bytes, where);
  throw InputError("{} is {}, can read F32, F64, F16, BF16, I32, I64 and U8; convert the file", where, entry.dtype);
}

template std::vector<float> SafetensorsFile::Values<float>(const std::string&) const;
template std::vector<double> SafetensorsFile::Values<double>(const std::string&) const;
template std::vector<int32_t> SafetensorsFile::Values<int32_t>(const std::string&) const;
template std::vector<int64_t> SafetensorsFile::Values<int64_t>(const std::string&) const;
template std::vector<uint8_t> SafetensorsFile::Values<uint8_t>(const std::string&) const;

std::string SerializeSafetensors(const std::map<std::string, TensorEntry>& tensors,
                                 const std::map<std::string, std::string>& metadata) {
  std::map<std::string, TensorLayout> layouts;
  for (const auto& [name, entry] : tensors) layouts[name] = {entry.dtype, entry.shape};
  const SafetensorsLayout layout = LayOutSafetensors(layouts, metadata);
  std::string out;
  out.reserve(layout.beginning.size() + layout.data_bytes);
  out += layout.beginning;
  for (const std::string& name : layout.order) {
    const TensorEntry& entry = tensors.at(name);
    if (TensorBytes(entry.shape, *ElementBytes(entry.dtype)) != entry.bytes.size()) {
      throw std::logic_error(fmt::format("safetensors: '{}' has {} bytes, its shape is [{}] of {}", name,
                                         entry.bytes.size(), fmt::join(entry.shape, ", "), entry.dtype));
    }
    out += entry.bytes;
  }
  return out;
}

}  // namespace oraclegs
