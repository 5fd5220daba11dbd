#pragma once

#include <string>

#include "oraclegs/core/subprocess.h"

namespace oraclegs {

/// Runs the ffmpeg command of `request`, which is ended when it makes no progress for StallLimit(). Returns "" or the
/// error: "ffmpeg failed (exit code 1): out.mp4: No space left on device".
std::string RunFfmpeg(ProcessRequest request);

}  // namespace oraclegs
