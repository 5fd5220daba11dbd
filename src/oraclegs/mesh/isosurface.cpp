#include "oraclegs/mesh/isosurface.h"

#include <dlfcn.h>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"

namespace oraclegs {
namespace {

constexpr const char* kOpenVdbLibrary = "liboraclegs_openvdb.so";
constexpr const char* kOpenVdbFunction = "oraclegs_openvdb_isosurface";

IsosurfaceFunction* LoadIsosurface() {
  const auto file = FindLibraryFile(kOpenVdbLibrary);
  if (!file) {
    throw UsageError(
        "a mesh needs OpenVDB, and {} is not here; install the Debian packages libopenvdb-dev and libboost-dev, and "
        "build oraclegs again",
        kOpenVdbLibrary);
  }
  void* handle = dlopen(file->c_str(), RTLD_NOW | RTLD_LOCAL);
  void* function = handle != nullptr ? dlsym(handle, kOpenVdbFunction) : nullptr;
  if (function == nullptr) {
    throw UsageError("{}: cannot be loaded; install libopenvdb-dev, and build oraclegs again ({})", file->string(),
                     dlerror());
  }
  return reinterpret_cast<IsosurfaceFunction*>(function);
}

IsosurfaceFunction* LoadedIsosurface() {
  static IsosurfaceFunction* const function = LoadIsosurface();
  return function;
}

}  // namespace

TriangleMesh Isosurface(const VoxelField& field) {
  TriangleMesh mesh;
  LoadedIsosurface()(field, &mesh);
  return mesh;
}

void RequireIsosurface() { LoadedIsosurface(); }

}  // namespace oraclegs
