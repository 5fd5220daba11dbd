#include "oraclegs/core/loaded_library.h"

#include <dlfcn.h>

#include <cstdlib>
#include <system_error>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

/// Turns the reason why the system's loader refuses a library into a UsageError.
[[noreturn]] void ThrowUnloadable(const LibraryKind& kind, const fs::path& file, const std::string& reason) {
  if (reason.find("undefined symbol") != std::string::npos) {
    throw UsageError("{}: is of another build than this program; build both together ({})", file.string(), reason);
  }
  if (reason.find("cannot open shared object file") != std::string::npos) {
    throw UsageError("{}: needs a library that is not here; {} ({})", file.string(), kind.how_to_fix, reason);
  }
  throw UsageError("{}: cannot be loaded; build it again, or {} ({})", file.string(), kind.how_to_fix, reason);
}

}  // namespace

std::optional<fs::path> FindLibraryOf(const LibraryKind& kind) {
  const char* given = kind.variable != nullptr ? std::getenv(kind.variable) : nullptr;
  if (given != nullptr) return given;
  return FindLibraryFile(kind.file);
}

bool HasLibraryOf(const LibraryKind& kind) {
  std::error_code ignored;
  const auto file = FindLibraryOf(kind);
  return file && fs::exists(*file, ignored);
}

LoadedLibrary::LoadedLibrary(const LibraryKind& kind, const fs::path& file) : kind_(kind), file_(file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) throw UsageError("{}: there is no such file; {}", file.string(), kind.how_to_get);
  handle_ = dlopen(fs::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle_ == nullptr) ThrowUnloadable(kind, file, dlerror());
  if (kind.build_function == nullptr) return;
  const std::string build = Find<const char*()>(kind.build_function)();
  if (build != kind.build) {
    throw UsageError("{}: is of another build ({}) than this program ({}); build both together", file.string(), build,
                     kind.build);
  }
}

void* LoadedLibrary::Symbol(const char* name) const {
  void* symbol = dlsym(handle_, name);
  if (symbol == nullptr) {
    throw UsageError("{}: is no library of {}, it has no {}; {}", file_.string(), kind_.content, name,
                     kind_.variable != nullptr ? fmt::format("name {} with ${}", kind_.file, kind_.variable)
                                               : "install the program again");
  }
  return symbol;
}

}  // namespace oraclegs
