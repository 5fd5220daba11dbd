#include "oraclegs/output/splat_folder.h"

#include <algorithm>
#include <map>

#include "oraclegs/core/error.h"
#include "oraclegs/formats/splat_file.h"
#include "oraclegs/workspace/workspace.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// The end that a word names, with or without its dot: "spz".
const std::string& KnownExtension(const std::string& word) {
  const std::string name = "splat" + std::string(word.starts_with('.') ? "" : ".") + word;
  for (const SplatFormat& format : SplatFormats()) {
    if (name == "splat" + format.extension) return format.extension;
  }
  throw UsageError("--format is {}: it must be one of {}", word.empty() ? "not given" : word, SplatExtensions());
}

bool HoldsSplat(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return SplatNameOf(path).has_value();
  return IsSplatFolder(path) || (IsWorkspace(path) && fs::exists(WorkspacePaths(path).point_cloud(), ignored));
}

}  // namespace

SplatJob SplatJobOf(const fs::path& splat, const fs::path& out, const std::string& extension) {
  std::error_code ignored;
  // "out/" has no name; its folder has one.
  const fs::path whole = fs::is_directory(splat, ignored) ? fs::weakly_canonical(splat, ignored) : splat;
  const std::string name = whole.filename().string();
  const bool folder = fs::is_directory(splat, ignored);
  return {splat, out / ((folder ? name : SplatNameOf(splat).value_or(name)) + KnownExtension(extension))};
}

std::vector<SplatJob> SplatJobsOf(const fs::path& folder, const fs::path& out, const std::string& extension) {
  const std::string& end = KnownExtension(extension);
  std::error_code error;
  const bool in_place = fs::equivalent(folder, out, error);
  std::vector<fs::path> splats;
  for (fs::directory_iterator entry(folder, error), last; !error && entry != last; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with('.') || !HoldsSplat(entry->path())) continue;
    if (in_place && SplatNameOf(entry->path()).value_or(name) + end == name) continue;
    splats.push_back(entry->path());
  }
  if (error) throw InputError("{}: cannot be read: {}", folder.string(), error.message());
  if (splats.empty()) {
    throw InputError("{}: holds no splat to convert; splats are files that end in {}, workspaces, and folders of SOG",
                     folder.string(), SplatExtensions());
  }
  std::sort(splats.begin(), splats.end());
  std::vector<SplatJob> jobs;
  std::map<fs::path, fs::path> from;
  for (const fs::path& splat : splats) {
    jobs.push_back(SplatJobOf(splat, out, end));
    const auto [other, is_new] = from.emplace(jobs.back().to, splat);
    if (is_new) continue;
    throw UsageError("{} and {} would both become {}; convert one of them alone, to another folder",
                     other->second.string(), splat.string(), jobs.back().to.string());
  }
  return jobs;
}

}  // namespace oraclegs
