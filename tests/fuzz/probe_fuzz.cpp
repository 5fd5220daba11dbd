// What ffprobe says of a video.

#include <cmath>

#include "fuzz/fuzz.h"
#include "oraclegs/capture/video.h"

ORACLEGS_FUZZ_TARGET(probe) {
  using namespace oraclegs;
  fuzz::Try([&] {
    const VideoInfo info = ParseProbe(bytes, "f");
    if (!(info.frames() > 2.5 && std::isfinite(info.frames()))) fuzz::Fail("no number of frames");
  });
}
