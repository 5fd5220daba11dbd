#include "oraclegs/core/share.h"

#include <fmt/format.h>

#include <charconv>

namespace oraclegs {
namespace {

std::optional<size_t> Number(std::string_view text) {
  size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

std::string ToText(const Share& share) { return fmt::format("{}/{}", share.index + 1, share.count); }

std::optional<Share> ParseShare(std::string_view text) {
  const size_t slash = text.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const auto number = Number(text.substr(0, slash)), count = Number(text.substr(slash + 1));
  if (!number || !count || *number < 1 || *number > *count) return std::nullopt;
  return Share{*number - 1, *count};
}

}  // namespace oraclegs
