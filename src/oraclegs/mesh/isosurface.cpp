#include "oraclegs/mesh/isosurface.h"

#include "oraclegs/core/error.h"
#include "oraclegs/core/loaded_library.h"

namespace oraclegs {
namespace {

IsosurfaceFunction* LoadIsosurface() {
  const LibraryKind kind{"liboraclegs_openvdb.so", "meshes", nullptr, "", "install the Debian package libopenvdb-dev"};
  const auto file = FindLibraryOf(kind);
  if (!file) {
    throw UsageError(
        "a mesh needs OpenVDB, and {} is not here; install the Debian packages libopenvdb-dev and libboost-dev, and "
        "build oraclegs again",
        kind.file);
  }
  return LoadedLibrary(kind, *file).Find<IsosurfaceFunction>("oraclegs_openvdb_isosurface");
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
