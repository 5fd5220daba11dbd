// PLY: Gaussians of any trainer, the compressed kind, and points.

#include "fuzz/fuzz.h"
#include "oraclegs/formats/codecs.h"
#include "oraclegs/gaussians/initialize.h"
#include "oraclegs/gaussians/ply.h"

ORACLEGS_FUZZ_TARGET(ply) {
  using namespace oraclegs;
  static const fuzz::Folder folder;
  fuzz::Try([&] { DecodeCompressedPly(bytes, "f"); });
  fuzz::Try([&] { ReadGaussianPly(folder.Put("a.ply", bytes)); });
  fuzz::Try([&] { ReadPointPly(folder.Put("a.ply", bytes)); });
}
