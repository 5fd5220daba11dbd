// HEIC and AVIF.

#include "fuzz/fuzz.h"
#include "fuzz/images.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/exif.h"

ORACLEGS_FUZZ_TARGET(heif) {
  using namespace oraclegs;
  if (!IsHeif(bytes)) return;
  ReadExif(bytes);
  if (!fuzz::IsSmall([&](int* width, int* height) { ReadHeifSize(bytes, "f", width, height); })) return;
  fuzz::Try([&] { DecodeHeif(bytes, "f"); });
}
