// USD: a text, or an archive of one (.usdz).

#include "fuzz/fuzz.h"
#include "oraclegs/formats/codecs.h"

ORACLEGS_FUZZ_TARGET(usd) {
  using namespace oraclegs;
  const bool packed = bytes.starts_with("PK");
  fuzz::Try([&] { packed ? DecodeUsdz(bytes, "f") : DecodeUsda(bytes, "f"); });
}
