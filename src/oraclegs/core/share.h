#pragma once
// The part of some work that one of several equal workers does.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace oraclegs {

/// Every count-th of parts that are numbered from 0, from `index` on; all of them unless set.
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
