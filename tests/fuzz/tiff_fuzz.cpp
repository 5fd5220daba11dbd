// TIFF.

#include "fuzz/fuzz.h"
#include "fuzz/images.h"
#include "oraclegs/image/codecs.h"

ORACLEGS_FUZZ_TARGET(tiff) {
  using namespace oraclegs;
  if (!IsTiff(bytes)) return;
  const auto size = [&](int* width, int* height) { ReadTiffSize(bytes, "f", Orientation::kUpright, width, height); };
  if (!fuzz::IsSmall(size)) return;
  fuzz::Try([&] { DecodeTiff(bytes, "f", Orientation::kUpright); });
}
