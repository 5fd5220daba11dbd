// EXIF: the block itself, and the containers it is looked for in; and the XMP of spheres. Damage there is no error.

#include "fuzz/fuzz.h"
#include "oraclegs/image/exif.h"
#include "oraclegs/image/gpano.h"

namespace {

void CheckExif(const oraclegs::Exif& exif) {
  for (const std::string& text : {exif.make, exif.model, exif.date}) {
    if (!text.empty()) oraclegs::fuzz::CheckMessage(text);
  }
  if (exif.orientation < 1 || exif.orientation > 8) oraclegs::fuzz::Fail("no orientation");
  const auto focal = oraclegs::FocalPixels(exif, 4000, 3000);
  if (focal && !(*focal > 0 && *focal < 1e6)) oraclegs::fuzz::Fail("no focal length");
}

}  // namespace

ORACLEGS_FUZZ_TARGET(exif) {
  using namespace oraclegs;
  CheckExif(ParseExif(bytes));
  CheckExif(ReadExif(bytes));
  ReadJpegMetadata(bytes);
  ReadProjection(bytes);
}
