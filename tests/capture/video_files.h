#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/core/subprocess.h"

namespace oraclegs {

/// A test pattern that moves, 160 x 120, ten frames a second; `more` are arguments before the output's.
inline void WriteVideo(const std::filesystem::path& path, double seconds, const std::vector<std::string>& more = {}) {
  std::vector<std::string> argv = {
      "ffmpeg", "-v",    "error", "-y",
      "-f",     "lavfi", "-i",    "testsrc2=size=160x120:rate=10:duration=" + std::to_string(seconds)};
  argv.insert(argv.end(), more.begin(), more.end());
  argv.insert(argv.end(), {"-c:v", "mpeg4", "-q:v", "3", path.string()});
  RunProcess(argv);
}

}  // namespace oraclegs
