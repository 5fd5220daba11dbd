// COLMAP's .bin files: any bytes as each of the three.

#include "fuzz/fuzz.h"
#include "oraclegs/scene/colmap_files.h"

ORACLEGS_FUZZ_TARGET(colmap_binary) {
  using namespace oraclegs;
  fuzz::Try([&] { ParseCamerasBinary(bytes, "f"); });
  fuzz::Try([&] { ParseImagesBinary(bytes, "f"); });
  fuzz::Try([&] { ParsePointsBinary(bytes, "f"); });
}
