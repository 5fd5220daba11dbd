#include "oraclegs/datasets/npy.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <optional>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr size_t kMaxAxes = 8;

/// The value behind a key of the header, which is a Python dictionary: the text from its first character on.
std::string_view ValueOf(std::string_view header, std::string_view key) {
  for (const char quote : {'\'', '"'}) {
    const std::string word = quote + std::string(key) + quote;
    size_t at = header.find(word);
    if (at == std::string_view::npos) continue;
    at = header.find_first_not_of(" \t", at + word.size());
    if (at == std::string_view::npos || header[at] != ':') continue;
    at = header.find_first_not_of(" \t", at + 1);
    if (at != std::string_view::npos) return header.substr(at);
  }
  return {};
}

/// The text between quotes at the beginning of a value; all of what is not text up to the next comma.
std::string_view WordOf(std::string_view value) {
  if (value.empty() || (value[0] != '\'' && value[0] != '"')) return value.substr(0, value.find(','));
  const size_t end = value.find(value[0], 1);
  return end == std::string_view::npos ? std::string_view() : value.substr(1, end - 1);
}

/// "(20, 17)" as numbers; nullopt for anything else. No number is larger than `max`, nor is their product.
std::optional<std::vector<int64_t>> ShapeOf(std::string_view value, int64_t max) {
  if (value.empty() || value[0] != '(') return std::nullopt;
  std::vector<int64_t> shape;
  int64_t product = 1;
  size_t at = 1;
  while (true) {
    while (at < value.size() && (value[at] == ' ' || value[at] == ',')) ++at;
    if (at >= value.size() || shape.size() > kMaxAxes) return std::nullopt;
    if (value[at] == ')') return product <= max ? std::optional(shape) : std::nullopt;
    if (!std::isdigit(static_cast<unsigned char>(value[at]))) return std::nullopt;
    int64_t side = 0;
    for (; at < value.size() && std::isdigit(static_cast<unsigned char>(value[at])); ++at) {
      side = 10 * side + (value[at] - '0');
      if (side > max) return std::nullopt;
    }
    if (side > 0 && product > max / side) return std::nullopt;
    product *= side;
    shape.push_back(side);
  }
}

/// Values that were stored with the first index fastest, with the last one fastest.
std::vector<double> InCOrder(const std::vector<int64_t>& shape, const std::vector<double>& values) {
  std::vector<double> ordered(values.size());
  std::vector<int64_t> index(shape.size(), 0);
  for (double& value : ordered) {
    int64_t at = 0;
    for (size_t axis = shape.size(); axis-- > 0;) at = at * shape[axis] + index[axis];
    value = values[static_cast<size_t>(at)];
    for (size_t axis = shape.size(); axis-- > 0;) {
      if (++index[axis] < shape[axis]) break;
      index[axis] = 0;
    }
  }
  return ordered;
}

template <class Float>
std::vector<double> Values(std::string_view bytes, size_t count) {
  std::vector<double> values(count);
  for (size_t i = 0; i < count; ++i) {
    Float value;
    std::memcpy(&value, bytes.data() + i * sizeof value, sizeof value);
    values[i] = static_cast<double>(value);
  }
  return values;
}

}  // namespace

std::string NpyArray::ShapeWords() const {
  return shape.empty() ? "a single number" : fmt::format("{}", fmt::join(shape, " x "));
}

NpyArray ParseNpy(std::string_view bytes, const std::string& file) {
  const size_t version_at = kMagic.size(), length_at = version_at + 2;
  if (!bytes.starts_with(kMagic) || bytes.size() < length_at + 2) {
    throw InputError("{}: is not a .npy file; save it with numpy.save", file);
  }
  const size_t length_bytes = bytes[version_at] == 1 ? 2 : 4;
  size_t length = 0;
  for (size_t i = length_bytes; i-- > 0 && length_at + i < bytes.size();) {
    length = length << 8 | static_cast<unsigned char>(bytes[length_at + i]);
  }
  const size_t header_at = length_at + length_bytes;
  if (header_at > bytes.size() || length > bytes.size() - header_at) {
    throw InputError("{}: is cut short within its header; copy or save it again", file);
  }
  const std::string_view header = bytes.substr(header_at, length), data = bytes.substr(header_at + length);
  const std::string_view type = WordOf(ValueOf(header, "descr"));
  if (type != "<f8" && type != "<f4") {
    throw InputError("{}: has numbers of type '{}', and '<f8' and '<f4' are read; save it with .astype('<f8')", file,
                     Printable(type));
  }
  const size_t item = type == "<f8" ? sizeof(double) : sizeof(float);
  const std::string_view shape_text = ValueOf(header, "shape");
  const auto shape = ShapeOf(shape_text, static_cast<int64_t>(data.size() / item));
  if (!shape) {
    throw InputError("{}: its {} bytes of numbers are fewer than its shape '{}' needs, or that is no shape", file,
                     data.size(), Printable(shape_text.substr(0, shape_text.find(')') + 1)));
  }
  size_t count = 1;
  for (const int64_t side : *shape) count *= static_cast<size_t>(side);
  NpyArray array{*shape, item == sizeof(double) ? Values<double>(data, count) : Values<float>(data, count)};
  if (ValueOf(header, "fortran_order").starts_with("True")) array.values = InCOrder(array.shape, array.values);
  return array;
}

}  // namespace oraclegs
