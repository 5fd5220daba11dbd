#include "oraclegs/core/host.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// The number behind `key` in a file of "key number" lines.
std::optional<uint64_t> NumberAfter(const fs::path& path, const std::string& key) {
  std::ifstream in(path);
  std::string word;
  while (in >> word) {
    uint64_t number = 0;
    if (word == key && in >> number) return number;
  }
  return std::nullopt;
}

std::optional<uint64_t> OnlyNumber(const fs::path& path) {
  std::ifstream in(path);
  uint64_t number = 0;
  if (in >> number) return number;  // "max" is none
  return std::nullopt;
}

/// The names that a version of control groups has for what we ask.
struct GroupFiles {
  std::vector<const char*> limits;
  const char* used;
  const char* cached;  // in memory.stat
};

/// Memory that a group has left, in bytes; nothing where it has no limit.
std::optional<uint64_t> LeftIn(const fs::path& group, const GroupFiles& files) {
  const auto used = OnlyNumber(group / files.used);
  std::optional<uint64_t> left;
  for (const char* name : files.limits) {
    const auto limit = OnlyNumber(group / name);
    if (!used || !limit) continue;
    // Files that nobody has touched lately are given back before anyone is killed.
    const uint64_t cached = NumberAfter(group / "memory.stat", files.cached).value_or(0);
    const uint64_t held = *used > cached ? *used - cached : 0;
    left = std::min(left.value_or(UINT64_MAX), *limit > held ? *limit - held : 0);
  }
  return left;
}

/// The least that is left in a group and in those above it, up to `top`. A container may see its group as the top, and
/// its path as the machine's.
std::optional<uint64_t> LeftUpFrom(const fs::path& top, const fs::path& path, const GroupFiles& files) {
  std::optional<uint64_t> least;
  for (fs::path at = path.lexically_normal().relative_path();; at = at.parent_path()) {
    if (const auto left = LeftIn(top / at, files)) least = std::min(least.value_or(UINT64_MAX), *left);
    if (at.empty()) return least;
  }
}

bool IsWordOf(const std::string& list, const std::string& word) {
  return ("," + list + ",").find("," + word + ",") != std::string::npos;
}

}  // namespace

const std::string& HostName() {
  static const std::string host = [] {
    std::array<char, 65> text{};  // the kernel's longest, and its end
    std::string name;
    if (gethostname(text.data(), text.size() - 1) == 0) name = text.data();
    const auto is_odd = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) == 0 && std::strchr("._-", c) == nullptr;
    };
    std::replace_if(name.begin(), name.end(), is_odd, '_');
    return name.empty() ? std::string("unknown") : name;
  }();
  return host;
}

uint64_t AvailableMemory(const fs::path& root) {
  const GroupFiles kVersion1 = {{"memory.limit_in_bytes"}, "memory.usage_in_bytes", "total_inactive_file"};
  const GroupFiles kVersion2 = {{"memory.max", "memory.high"}, "memory.current", "inactive_file"};
  const fs::path groups = root / "sys/fs/cgroup";
  uint64_t available = NumberAfter(root / "proc/meminfo", "MemAvailable:").value_or(0) * 1024;
  const auto consider = [&](const std::optional<uint64_t>& left) {
    if (left) available = available == 0 ? *left : std::min(available, *left);
  };
  // Lines of "number:controllers:path"; those of version 2 have no controllers.
  std::ifstream own(root / "proc/self/cgroup");
  for (std::string line; std::getline(own, line);) {
    const size_t first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1), path = line.substr(second + 1);
    if (controllers.empty()) consider(LeftUpFrom(groups, path, kVersion2));
    if (IsWordOf(controllers, "memory")) consider(LeftUpFrom(groups / "memory", path, kVersion1));
  }
  return available;
}

int64_t PeakMemoryBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return int64_t{usage.ru_maxrss} * 1024;
}

}  // namespace oraclegs
