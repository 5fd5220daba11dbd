#include "oraclegs/networks/loader.h"

#include <dlfcn.h>

#include <cstdlib>
#include <map>
#include <mutex>
#include <optional>
#include <system_error>

#include "oraclegs/core/files.h"
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

/// Path that the environment variable names, whether it exists or not; else the library found beside the program, or
/// nullopt.
std::optional<fs::path> FindLibrary() {
  if (const char* given = std::getenv(kNetworksVariable)) return given;
  return FindLibraryFile(kLibrary);
}

/// Turns the reason why the system's loader refuses a library into a UsageError.
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
