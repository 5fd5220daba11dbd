// SPZ: a file as it is, and what gzip has packed in one.

#include "fuzz/fuzz.h"
#include "oraclegs/formats/codecs.h"

ORACLEGS_FUZZ_TARGET(spz) {
  using namespace oraclegs;
  const bool packed = bytes.starts_with("\x1f\x8b");
  const std::string file = packed ? std::string(bytes) : fuzz::StoredGzip(bytes);
  fuzz::Try([&] { DecodeSpz(file, "f"); });
  if (!packed) fuzz::Try([&] { DecodeSpz(bytes, "f"); });
}
