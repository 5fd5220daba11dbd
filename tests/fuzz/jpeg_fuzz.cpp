// JPEG: both orientations, the reduced kind, and what stands before the pixels.

#include "fuzz/fuzz.h"
#include "fuzz/images.h"
#include "oraclegs/image/codecs.h"
#include "oraclegs/image/exif.h"

ORACLEGS_FUZZ_TARGET(jpeg) {
  using namespace oraclegs;
  ReadJpegMetadata(bytes);
  ReadExif(bytes);
  if (!IsJpeg(bytes)) return;
  const auto size = [&](int* width, int* height) { ReadJpegSize(bytes, "f", Orientation::kUpright, width, height); };
  if (!fuzz::IsSmall(size)) return;
  fuzz::Try([&] { DecodeJpeg(bytes, "f", Orientation::kUpright); });
  fuzz::Try([&] { DecodeReducedJpeg(bytes, "f", 8); });
}
