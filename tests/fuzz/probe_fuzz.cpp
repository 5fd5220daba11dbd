// What ffprobe says of a video.

#include "fuzz/fuzz.h"
#include "oraclegs/capture/video.h"

ORACLEGS_FUZZ_TARGET(probe) {
  using namespace oraclegs;
  fuzz::Try([&] {
    if (ParseProbe(bytes, "f") < 3) fuzz::Fail("no number of frames");
  });
}
