#pragma once

#include <string>

#include "oraclegs/core/subprocess.h"

namespace oraclegs {

/// Runs the ffmpeg command of `request`, which ends when it does nothing for StallLimit(). Empty, or what went wrong in
/// words: "ffmpeg failed (exit code 1): out.mp4: No space left on device".
std::string RunFfmpeg(ProcessRequest request);

}  // namespace oraclegs
