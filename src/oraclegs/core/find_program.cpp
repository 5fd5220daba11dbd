#include "oraclegs/core/find_program.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace oraclegs {
namespace fs = std::filesystem;
namespace {

bool IsProgram(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && access(path.c_str(), X_OK) == 0;
}

}  // namespace

fs::path FindProgram(const std::string& name) {
  if (name.empty()) return {};
  if (name.find('/') != std::string::npos) return IsProgram(name) ? fs::absolute(name) : fs::path();
  const char* path = std::getenv("PATH");
  std::string_view folders = path ? path : "/usr/local/bin:/usr/bin:/bin";
  while (true) {
    const size_t colon = std::min(folders.find(':'), folders.size());
    const fs::path candidate = fs::path(colon == 0 ? "." : std::string(folders.substr(0, colon))) / name;
    if (IsProgram(candidate)) return fs::absolute(candidate);
    if (colon == folders.size()) return {};
    folders.remove_prefix(colon + 1);
  }
}

}  // namespace oraclegs
