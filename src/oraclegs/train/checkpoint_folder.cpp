#include "oraclegs/train/checkpoint_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <string_view>

#include "oraclegs/core/atomic_file.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "iteration_", kSuffix = ".safetensors";
constexpr size_t kCheckpointsKept = 2;

/// The iteration in a checkpoint's name, -1 for any other file.
int64_t IterationOf(const fs::path& path) {
  const std::string name = path.filename().string();
  if (name.size() <= kPrefix.size() + kSuffix.size() || name.rfind(kPrefix, 0) != 0) return -1;
  const char* const end = name.data() + name.size() - kSuffix.size();
  if (std::string_view(end, kSuffix.size()) != kSuffix) return -1;
  int64_t iteration = -1;
  const auto [stop, error] = std::from_chars(name.data() + kPrefix.size(), end, iteration);
  return error == std::errc() && stop == end ? iteration : -1;
}

/// Checkpoints of a folder by iteration.
std::map<int64_t, fs::path> ListCheckpoints(const fs::path& dir) {
  std::map<int64_t, fs::path> found;
  std::error_code ignored;  // a folder that is not there has none
  for (const auto& entry : fs::directory_iterator(dir, ignored)) {
    const int64_t iteration = IterationOf(entry.path());
    if (iteration >= 0) found[iteration] = entry.path();
  }
  return found;
}

}  // namespace

fs::path CheckpointPath(const fs::path& dir, int64_t iteration) {
  return dir / fmt::format("{}{:07}{}", kPrefix, iteration, kSuffix);
}

std::vector<fs::path> FindCheckpoints(const fs::path& dir) {
  std::vector<fs::path> paths;
  for (const auto& [iteration, path] : ListCheckpoints(dir)) paths.push_back(path);
  std::reverse(paths.begin(), paths.end());
  return paths;
}

std::optional<fs::path> NewestCheckpoint(const fs::path& dir) {
  const std::vector<fs::path> found = FindCheckpoints(dir);
  if (found.empty()) return std::nullopt;
  return found.front();
}

void RemoveOldCheckpoints(const fs::path& dir, int64_t iteration) {
  std::error_code ignored;  // what cannot be removed does no harm
  size_t kept = 0;
  const auto found = ListCheckpoints(dir);
  for (auto it = found.rbegin(); it != found.rend(); ++it) {
    if (it->first <= iteration && kept++ < kCheckpointsKept) continue;
    fs::remove(it->second, ignored);
  }
  RemoveLeftovers(dir);
}

std::string WhereToContinue(const fs::path& dir) {
  if (dir.empty()) return "nothing was saved";
  const auto newest = NewestCheckpoint(dir);
  if (!newest) return "no checkpoint had been saved yet (--checkpoint-every)";
  return fmt::format(
      "the last checkpoint, {}, is whole: the same command continues from it where more memory is free, or with "
      "--device cpu; with lower settings training starts anew (--overwrite)",
      newest->string());
}

std::string WhatIsSaved(const fs::path& dir) {
  const auto newest = dir.empty() ? std::nullopt : NewestCheckpoint(dir);
  return newest ? fmt::format("{} was saved before that", newest->string()) : "nothing had been saved";
}

}  // namespace oraclegs
