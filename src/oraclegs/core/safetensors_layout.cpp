#include "oraclegs/core/safetensors_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"

namespace oraclegs {
namespace {

constexpr size_t kDataAlignment = 8;  // of the numbers in the file

constexpr std::string_view kIndexEnding = ".index.json", kSafetensors = ".safetensors", kTorch = ".bin";
constexpr uint64_t kMaxIndexBytes = 100'000'000;

bool IsIndexOf(std::string_view parts, const std::filesystem::path& path) {
  return path.string().ends_with(std::string(parts) + std::string(kIndexEnding));
}

bool IsPartName(std::string_view name, std::string_view ending) {
  return name.size() > ending.size() && name.ends_with(ending) && name.front() != '.' &&
         name.find_first_of(std::string_view("/\\\0", 3)) == std::string_view::npos;
}

}  // namespace

std::optional<uint64_t> ElementBytes(const std::string& dtype) {
  static const std::map<std::string, uint64_t> kBytes = {
      {"BOOL", 1}, {"U8", 1},  {"I8", 1},  {"F8_E4M3", 1}, {"F8_E5M2", 1}, {"U16", 2}, {"I16", 2}, {"F16", 2},
      {"BF16", 2}, {"U32", 4}, {"I32", 4}, {"F32", 4},     {"U64", 8},     {"I64", 8}, {"F64", 8}};
  const auto it = kBytes.find(dtype);
  if (it == kBytes.end()) return std::nullopt;
  return it->second;
}

std::optional<uint64_t> TensorBytes(const std::vector<int64_t>& shape, uint64_t element_bytes) {
  int64_t bytes = static_cast<int64_t>(element_bytes);
  for (const int64_t size : shape) {
    if (size < 0 || __builtin_mul_overflow(bytes, size, &bytes)) return std::nullopt;
  }
  return static_cast<uint64_t>(bytes);
}

SafetensorsLayout LayOutSafetensors(const std::map<std::string, TensorLayout>& tensors,
                                    const std::map<std::string, std::string>& metadata) {
  constexpr auto kMost = static_cast<uint64_t>(std::numeric_limits<int64_t>::max());
  std::vector<std::pair<uint64_t, const std::string*>> order;
  for (const auto& [name, tensor] : tensors) {
    const auto element_bytes = ElementBytes(tensor.dtype);
    if (name == "__metadata__" || !element_bytes || !IsUtf8(name)) {
      throw std::logic_error(fmt::format("safetensors: cannot store '{}' of dtype '{}'", name, tensor.dtype));
    }
    order.emplace_back(*element_bytes, &name);
  }
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first > b.first; });

  SafetensorsLayout layout;
  nlohmann::ordered_json header = nlohmann::ordered_json::object();
  if (!metadata.empty()) header["__metadata__"] = metadata;
  for (const auto& [width, name] : order) {
    const TensorLayout& tensor = tensors.at(*name);
    const auto bytes = TensorBytes(tensor.shape, width);
    if (!bytes || *bytes > kMost - layout.data_bytes) {
      throw std::logic_error(fmt::format("safetensors: '{}' is too large or has a negative size", *name));
    }
    const uint64_t end = layout.data_bytes + *bytes;
    header[*name] = {{"dtype", tensor.dtype}, {"shape", tensor.shape}, {"data_offsets", {layout.data_bytes, end}}};
    layout.data_bytes = end;
    layout.order.push_back(*name);
  }
  std::string text = header.dump();
  text.resize((text.size() + kDataAlignment - 1) / kDataAlignment * kDataAlignment, ' ');
  for (uint64_t i = 0; i < sizeof(uint64_t); ++i) {
    layout.beginning.push_back(static_cast<char>(uint64_t{text.size()} >> (8 * i)));
  }
  layout.beginning += text;
  return layout;
}

bool IsShardIndex(const std::filesystem::path& path) { return IsIndexOf(kSafetensors, path); }
bool IsTorchShardIndex(const std::filesystem::path& path) { return IsIndexOf(kTorch, path); }

std::map<std::string, std::set<std::string>> ReadShardIndex(const std::filesystem::path& path) {
  const std::string file = path.string();
  const nlohmann::json index = ParseUniqueJson(ReadFile(path, kMaxIndexBytes), file, "index");
  if (!index.is_object() || !index.contains("weight_map") || !index["weight_map"].is_object()) {
    throw InputError("{}: has no weight_map, which says where each tensor is; get the file again", file);
  }
  const std::string_view ending = IsTorchShardIndex(path) ? kTorch : kSafetensors;
  std::map<std::string, std::set<std::string>> parts;
  for (const auto& [tensor, part] : index["weight_map"].items()) {
    if (!part.is_string() || !IsPartName(part.get_ref<const std::string&>(), ending)) {
      const std::string found = part.is_string() ? QuotedForMessage(part.get<std::string>()) : "no text";
      throw InputError("{}: seeks tensor {} in {}, expected the name of a {} file beside it; get it again", file,
                       QuotedForMessage(tensor), found, ending);
    }
    parts[part.get<std::string>()].insert(tensor);
  }
  if (parts.empty()) throw InputError("{}: its weight_map is empty; get the file again", file);
  return parts;
}

}  // namespace oraclegs
