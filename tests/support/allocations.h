#pragma once

#include <cstdint>
#include <string>

namespace oraclegs {

/// Counts the heap allocations of all threads between Begin and End. An executable that links this gets its malloc.
class AllocationCounter {
 public:
  /// Whether this build can count: it needs glibc, and sanitizers bring a malloc of their own.
  static bool Works();

  static void Begin();
  /// Number of allocations since Begin.
  static int64_t End();
  /// Bytes allocated since Begin, freed ones included.
  static int64_t Bytes();
  /// Call stack of the first of them, one address a line (addr2line -Cfe BINARY ADDRESS shows the source).
  static std::string First();
};

}  // namespace oraclegs
