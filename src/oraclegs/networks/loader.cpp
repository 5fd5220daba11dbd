#include "oraclegs/networks/loader.h"

#include <dlfcn.h>

#include <cstdlib>
#include <map>
#include <mutex>
#include <optional>
#include <system_error>
#include <vector>

#include "oraclegs/core/parallel.h"
#include "oraclegs/networks/build_id.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLibrary = "liboraclegs_networks.so";

#if defined(ORACLEGS_NETWORKS)
constexpr const char* kHowToGet = "install it beside the program, or build the target oraclegs_networks_plugin";
#else
constexpr const char* kHowToGet =
    "this program was built without libtorch: install the Debian package libtorch-dev and configure with "
    "-DORACLEGS_NETWORKS=ON";
#endif

/// The folder of the shared library that holds `function`, or of the program.
std::optional<fs::path> FolderOf(const void* function) {
  Dl_info info{};
  if (dladdr(function, &info) == 0 || info.dli_fname == nullptr) return std::nullopt;
  std::error_code ignored;
  const fs::path file = fs::canonical(info.dli_fname, ignored);
  if (file.empty()) return std::nullopt;
  return file.parent_path();
}

std::vector<fs::path> Folders() {
  std::vector<fs::path> folders;
  // Of liboraclegs_core.so, which program and library of networks share.
  if (const auto core = FolderOf(reinterpret_cast<const void*>(&NumThreads))) folders.push_back(*core);
  std::error_code ignored;
  const fs::path program = fs::canonical("/proc/self/exe", ignored);
  if (program.empty()) return folders;
  for (const char* beside : {".", "../lib", "../lib/oraclegs"}) folders.push_back(program.parent_path() / beside);
  return folders;
}

/// Nothing when there is none; what the variable names, whether it is there or not.
std::optional<fs::path> FindLibrary() {
  if (const char* given = std::getenv(kNetworksVariable)) return given;
  for (const fs::path& folder : Folders()) {
    std::error_code ignored;
    if (fs::exists(folder / kLibrary, ignored)) return (folder / kLibrary).lexically_normal();
  }
  return std::nullopt;
}

/// What is wrong with a library that the system's loader refuses, from its words.
[[noreturn]] void ThrowUnloadable(const fs::path& library, const std::string& reason) {
  if (reason.find("undefined symbol") != std::string::npos) {
    throw UsageError("{}: is of another build than this program; build both together ({})", library.string(), reason);
  }
  if (reason.find("libtorch") != std::string::npos || reason.find("libc10") != std::string::npos) {
    throw UsageError("{}: needs libtorch; install the Debian package libtorch-dev ({})", library.string(), reason);
  }
  throw UsageError("{}: cannot be loaded; build it again, or install libtorch-dev ({})", library.string(), reason);
}

template <class Function>
Function* Exported(void* handle, const fs::path& library, const char* name) {
  void* symbol = dlsym(handle, name);
  if (symbol == nullptr) {
    throw UsageError("{}: is no library of networks, it has no {}; name {} with ${}", library.string(), name, kLibrary,
                     kNetworksVariable);
  }
  return reinterpret_cast<Function*>(symbol);
}

}  // namespace

const Networks& LoadNetworks(const fs::path& library) {
  static std::mutex mutex;
  static std::map<fs::path, const Networks*> loaded;
  const std::lock_guard lock(mutex);
  const auto known = loaded.find(library);
  if (known != loaded.end()) return *known->second;
  std::error_code ignored;
  if (!fs::exists(library, ignored)) throw UsageError("{}: there is no such file; {}", library.string(), kHowToGet);
  void* handle = dlopen(fs::absolute(library).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) ThrowUnloadable(library, dlerror());
  const std::string build = Exported<const char*()>(handle, library, kBuildFunction)();
  if (build != NetworksBuildId()) {
    throw UsageError("{}: is of another build ({}) than this program ({}); build both together", library.string(),
                     build, NetworksBuildId());
  }
  const Networks* networks = Exported<const Networks*()>(handle, library, kCreateFunction)();
  loaded.emplace(library, networks);
  return *networks;
}

bool HasNetworksLibrary() {
  std::error_code ignored;
  const auto library = FindLibrary();
  return library && fs::exists(*library, ignored);
}

void RequireNetworksLibrary(const std::string& needs) {
  if (HasNetworksLibrary()) return;
  throw UsageError("{} needs networks, and {} is not here; {}", needs, kLibrary, kHowToGet);
}

const Networks& GetNetworks() {
  const auto library = FindLibrary();
  if (!library) throw UsageError("networks need {}, which is not here; {}", kLibrary, kHowToGet);
  return LoadNetworks(*library);
}

std::string WhyNoNetworks() {
  try {
    GetNetworks();
    return "";
  } catch (const UsageError& error) {
    return error.what();
  }
}

}  // namespace oraclegs
