#include "oraclegs/core/safetensors_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

constexpr size_t kDataAlignment = 8;  // of the numbers in the file

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

}  // namespace oraclegs
