// WebP: of photos, and of the images in a SOG file.

#include "fuzz/fuzz.h"
#include "fuzz/images.h"
#include "oraclegs/formats/webp.h"
#include "oraclegs/image/codecs.h"

ORACLEGS_FUZZ_TARGET(webp) {
  using namespace oraclegs;
  fuzz::Try([&] { DecodeWebp(bytes, fuzz::kSmallPixels, "f"); });
  if (!IsWebp(bytes)) return;
  const auto size = [&](int* width, int* height) { ReadWebpSize(bytes, "f", Orientation::kUpright, width, height); };
  if (!fuzz::IsSmall(size)) return;
  fuzz::Try([&] { DecodeWebp(bytes, "f", Orientation::kUpright); });
}
