#pragma once

#include <fmt/format.h>

#include <concepts>
#include <string>
#include <string_view>

namespace oraclegs {

/// "1 view", "0 views", "12 views": a count with a noun whose plural has an s more.
template <std::integral Count>
std::string Counted(Count count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace oraclegs
