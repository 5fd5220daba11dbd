#include "oraclegs/core/find_program.h"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <vector>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace fs = std::filesystem;
namespace {

bool IsProgram(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && access(path.c_str(), X_OK) == 0;
}

namespace fs = std::filesystem;

/// The folder of the shared library that holds `function`, or of the program.
std::optional<fs::path> FolderOf(const void* function) {
  Dl_info info{};
  if (dladdr(function, &info) == 0 || info.dli_fname == nullptr) return std::nullopt;
  std::error_code ignored;
  const fs::path file = fs::canonical(info.dli_fname, ignored);
  if (file.empty()) return std::nullopt;
  return file.parent_path();
}

std::vector<fs::path> LibraryFolders() {
  std::vector<fs::path> folders;
  // The folder of liboraclegs_core.so, which the program and its libraries share, comes first.
  if (const auto core = FolderOf(reinterpret_cast<const void*>(&NumThreads))) folders.push_back(*core);
  std::error_code ignored;
  const fs::path program = fs::canonical("/proc/self/exe", ignored);
  if (program.empty()) return folders;
  for (const char* beside : {".", "../lib", "../lib/oraclegs"}) folders.push_back(program.parent_path() / beside);
  return folders;
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

std::optional<fs::path> FindLibraryFile(const std::string& name) {
  for (const fs::path& folder : LibraryFolders()) {
    std::error_code ignored;
    if (fs::exists(folder / name, ignored)) return (folder / name).lexically_normal();
  }
  return std::nullopt;
}

}  // namespace oraclegs
