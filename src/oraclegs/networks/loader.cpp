#include "oraclegs/networks/loader.h"

#include <map>
#include <mutex>

#include "oraclegs/core/config.h"
#include "oraclegs/core/loaded_library.h"
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

const LibraryKind& Kind() {
  static const LibraryKind kind{
      kLibrary,       "networks",       kNetworksVariable, kHowToGet, "install the Debian package libtorch-dev",
      kBuildFunction, NetworksBuildId()};
  return kind;
}

}  // namespace

const Networks& LoadNetworks(const fs::path& library) {
  static std::mutex mutex;
  static std::map<fs::path, const Networks*> loaded;
  const std::lock_guard lock(mutex);
  const auto known = loaded.find(library);
  if (known != loaded.end()) return *known->second;
  const Networks* networks = LoadedLibrary(Kind(), library).Find<const Networks*()>(kCreateFunction)();
  loaded.emplace(library, networks);
  return *networks;
}

bool HasNetworksLibrary() { return HasLibraryOf(Kind()); }

void RequireNetworksLibrary(const std::string& needs) {
  if (HasNetworksLibrary()) return;
  throw UsageError("{} needs networks, and {} is not here; {}", needs, kLibrary, kHowToGet);
}

const Networks& GetNetworks() {
  const auto library = FindLibraryOf(Kind());
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
