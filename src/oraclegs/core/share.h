#pragma once
// What one of several equal workers does of some work.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace oraclegs {

/// Of parts that are numbered from 0, every count-th, from `index` on. As it is, all of them.
struct Share {
  size_t index = 0;  ///< below count
  size_t count = 1;  ///< from 1

  bool Has(size_t part) const { return part % count == index; }
  bool operator==(const Share&) const = default;
};

/// "2/3" for the second of three.
std::string ToText(const Share& share);

/// Nothing unless the text is a share as ToText writes it.
std::optional<Share> ParseShare(std::string_view text);

}  // namespace oraclegs
