// COLMAP's .txt files: any bytes as each of the three.

#include "fuzz/fuzz.h"
#include "oraclegs/scene/colmap_files.h"

ORACLEGS_FUZZ_TARGET(colmap_text) {
  using namespace oraclegs;
  fuzz::Try([&] { ParseCamerasText(bytes, "f"); });
  fuzz::Try([&] { ParseImagesText(bytes, "f"); });
  fuzz::Try([&] { ParsePointsText(bytes, "f"); });
}
