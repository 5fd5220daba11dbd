// What ffprobe says of a video.

#include "fuzz/fuzz.h"
#include "oraclegs/capture/video.h"

ORACLEGS_FUZZ_TARGET(probe) {
  using namespace oraclegs;
  fuzz::Try([&] {
    const VideoInfo info = ParseProbe(bytes, "f");
    if (!(info.frames() >= 3 && info.frames() < 1e300)) fuzz::Fail("no number of frames");
  });
}
