#pragma once

#include <cstdint>
#include <string>

namespace oraclegs {

/// Counts what all threads of this program take from the heap, between Begin and End. An executable that links
/// this gets its malloc.
class AllocationCounter {
 public:
  /// Whether this build can count: it needs glibc, and sanitizers bring a malloc of their own.
  static bool Works();

  static void Begin();
  /// How many allocations there were since Begin.
  static int64_t End();
  /// How many bytes they asked for, those that were given back included.
  static int64_t Bytes();
  /// Where the first of them came from, one address a line (addr2line -Cfe BINARY ADDRESS shows the source).
  static std::string First();
};

}  // namespace oraclegs
