// PLY: Gaussians of any trainer, the compressed kind, and meshes.

#include "fuzz/fuzz.h"
#include "oraclegs/formats/compressed_ply.h"
#include "oraclegs/gaussians/ply.h"
#include "oraclegs/mesh/mesh_file.h"

ORACLEGS_FUZZ_TARGET(ply) {
  using namespace oraclegs;
  static const fuzz::Folder folder;
  fuzz::Try([&] { DecodeCompressedPly(bytes, "f"); });
  const auto file = folder.Put("a.ply", bytes);
  fuzz::Try([&] { ReadGaussianPly(file); });
  fuzz::Try([&] { ReadMeshPly(file); });
}
