#include "oraclegs/core/memory.h"

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <string>

namespace oraclegs {
namespace {

/// The number behind `key` in a file of "key number" lines.
std::optional<uint64_t> NumberAfter(const char* path, const std::string& key) {
  std::ifstream in(path);
  std::string word;
  while (in >> word) {
    uint64_t number = 0;
    if (word == key && in >> number) return number;
  }
  return std::nullopt;
}

std::optional<uint64_t> OnlyNumber(const char* path) {
  std::ifstream in(path);
  uint64_t number = 0;
  if (in >> number) return number;  // "max" is none
  return std::nullopt;
}

}  // namespace

uint64_t AvailableMemory() {
  uint64_t available = NumberAfter("/proc/meminfo", "MemAvailable:").value_or(0) * 1024;
  const auto limit = OnlyNumber("/sys/fs/cgroup/memory.max"), used = OnlyNumber("/sys/fs/cgroup/memory.current");
  if (limit && used) {
    // Files that nobody has touched lately are given back before anyone is killed.
    const uint64_t cached = NumberAfter("/sys/fs/cgroup/memory.stat", "inactive_file").value_or(0);
    const uint64_t held = *used > cached ? *used - cached : 0, left = *limit > held ? *limit - held : 0;
    available = available == 0 ? left : std::min(available, left);
  }
  return available;
}

int64_t PeakMemoryBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return int64_t{usage.ru_maxrss} * 1024;
}

}  // namespace oraclegs
