#include "oraclegs/datasets/pose_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/scene/scene.h"

namespace oraclegs {

namespace fs = std::filesystem;

std::vector<fs::path> FilesThatEnd(const fs::path& dir, std::string_view end) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(dir, error), last; !error && it != last; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.ends_with(end) && !name.starts_with(".") && IsFile(it->path())) files.push_back(it->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string HeadOfPoseFile(const fs::path& path) {
  constexpr size_t kHeadBytes = 64 * 1024;
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  std::string head = ReadHead(path, kHeadBytes);
  if (head.starts_with(kMark)) head.erase(0, kMark.size());
  return head;
}

void ReportUnplaced(const std::string& file, const std::vector<std::string>& names, const Listener& listener) {
  if (names.empty()) return;
  listener(Warning{fmt::format("{}: has no pose for {} and leaves {} out: {}", file, Counted(names.size(), "photo"),
                               names.size() == 1 ? "it" : "them", SomeNames(names))});
}

}  // namespace oraclegs
