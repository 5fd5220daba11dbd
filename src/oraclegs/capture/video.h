#pragma once
// Photos out of a video, by the programs ffprobe and ffmpeg.

#include <filesystem>
#include <string_view>
#include <vector>

#include "oraclegs/core/progress.h"

namespace oraclegs {

struct VideoInfo {
  double seconds = 0;
  double frames_per_second = 0;

  double frames() const { return seconds * frames_per_second; }
};

/// True for the name or the first bytes of a video.
bool LooksLikeVideo(const std::filesystem::path& path);

/// Throws InputError naming the file and the fix: ffmpeg is not installed, the file holds no video that it can read, or
/// fewer than three frames.
VideoInfo ProbeVideo(const std::filesystem::path& video);

/// What ffprobe printed of `video`, JSON. Throws InputError as ProbeVideo does.
VideoInfo ParseProbe(std::string_view output, const std::filesystem::path& video);

/// Writes the sharpest frame of each of `frames` equal parts of the video to dir/frame_0001.jpg ..., upright. `dir` is
/// made; nothing else stays in it. Reports StepDone{"import"}. Throws InputError when ffmpeg cannot decode the video,
/// RunError when `dir` cannot be written.
void ExtractFrames(const std::filesystem::path& video, int frames, const std::filesystem::path& dir,
                   const Listener& listener);

}  // namespace oraclegs
