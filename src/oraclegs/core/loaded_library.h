#pragma once
// Libraries that belong to this program and are loaded when they are needed: networks, meshes, GPUs.

#include <filesystem>
#include <optional>
#include <string>

namespace oraclegs {

/// A library, and the words of its errors.
struct LibraryKind {
  std::string file;        ///< "liboraclegs_cuda.so"
  std::string content;     ///< "networks": of which it is a library
  const char* variable;    ///< environment variable that names another file, in place of the search; null = none
  std::string how_to_get;  ///< where there is none: "install it beside the program"
  std::string how_to_fix;  ///< where the system's loader refuses it: "install libtorch-dev"
  const char* build_function = nullptr;  ///< exported `const char* ()`: the build it is of; null = not asked
  std::string build = {};                ///< that it has to be of
};

/// File that the variable names, whether it exists or not; else the one found by FindLibraryFile (files.h), or nothing.
std::optional<std::filesystem::path> FindLibraryOf(const LibraryKind& kind);

/// True when there is a file. Whether it loads shows when it is opened.
bool HasLibraryOf(const LibraryKind& kind);

/// An open library. It stays open to the end of the program, also without this handle.
class LoadedLibrary {
 public:
  /// Opens `file`. Throws UsageError, which names the file and says what to do, when it is missing, does not load, is
  /// another library or of another build.
  LoadedLibrary(const LibraryKind& kind, const std::filesystem::path& file);

  /// Exported function. Throws UsageError when there is none of that name.
  template <class Function>
  Function* Find(const char* name) const {
    return reinterpret_cast<Function*>(Symbol(name));
  }

 private:
  void* Symbol(const char* name) const;

  LibraryKind kind_;
  std::filesystem::path file_;
  void* handle_ = nullptr;
};

}  // namespace oraclegs
