#include "oraclegs/image/gpano.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>

namespace oraclegs {
namespace {

constexpr size_t kMaxValue = 64;  // characters
constexpr std::string_view kBlanks = " \t\r\n";

std::string_view Trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.size(), text.find_first_not_of(kBlanks)));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

/// The value of GPano:NAME="value" or <GPano:NAME>value</GPano:NAME>, empty where it is cut off; nothing without one.
std::optional<std::string_view> ValueOf(std::string_view head, std::string_view name) {
  const std::string key = "GPano:" + std::string(name);
  const size_t at = head.find(key);
  if (at == std::string_view::npos) return std::nullopt;
  std::string_view rest = Trimmed(head.substr(at + key.size(), kMaxValue));
  char end = '<';
  if (rest.starts_with('=')) {
    rest = Trimmed(rest.substr(1));
    if (!rest.starts_with('"') && !rest.starts_with('\'')) return "";
    end = rest.front();
  } else if (!rest.starts_with('>')) {
    return "";
  }
  rest.remove_prefix(1);
  const size_t length = rest.find(end);
  return length == std::string_view::npos ? std::string_view() : Trimmed(rest.substr(0, length));
}

/// -1 for what is no whole number of pixels.
int NumberOf(std::string_view text) {
  int number = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && stop == text.data() + text.size() ? std::max(-1, number) : -1;
}

/// Whether the picture begins at the sphere's `edge` and has its whole side, where the metadata says anything of it.
bool IsWhole(std::string_view head, std::string_view edge, const std::string& side) {
  const auto begin = ValueOf(head, "CroppedArea" + std::string(edge));
  const auto full = ValueOf(head, "FullPano" + side), cropped = ValueOf(head, "CroppedAreaImage" + side);
  if (begin && NumberOf(*begin) != 0) return false;
  return !full || !cropped || (NumberOf(*full) > 0 && NumberOf(*full) == NumberOf(*cropped));
}

}  // namespace

Projection ReadProjection(std::string_view head) {
  const auto type = ValueOf(head, "ProjectionType");
  if (!type) return Projection::kPlain;
  std::string lower(*type);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  const bool is_sphere = lower == "equirectangular" && IsWhole(head, "LeftPixels", "WidthPixels") &&
                         IsWhole(head, "TopPixels", "HeightPixels");
  return is_sphere ? Projection::kSphere : Projection::kPanorama;
}

}  // namespace oraclegs
