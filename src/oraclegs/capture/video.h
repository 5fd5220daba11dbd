#pragma once
// Photos out of a video, by the programs ffprobe and ffmpeg.

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "oraclegs/core/progress.h"

namespace oraclegs {

/// True for the name or the first bytes of a video.
bool LooksLikeVideo(const std::filesystem::path& path);

/// Counts the frames of a video. A list of other files is no video. Throws InputError naming the file and the fix:
/// ffmpeg is not installed, the file holds no video that it can read, or fewer than three frames.
int64_t ProbeVideo(const std::filesystem::path& video);

/// Number of frames in what ffprobe printed of `video`, JSON. Throws InputError as ProbeVideo does.
int64_t ParseProbe(std::string_view output, const std::filesystem::path& video);

/// Writes the sharpest frame of each of `frames` equal parts of the video to dir/frame_0001.jpg ..., upright. Parts
/// have equal numbers of frames, whatever times and durations the file claims. At most five times `frames` images are
/// on the disk at once. `dir` is made; nothing else stays in it. Reports StepDone{"import"}. Throws InputError when
/// ffmpeg cannot decode the video, RunError when `dir` cannot be written.
void ExtractFrames(const std::filesystem::path& video, int frames, const std::filesystem::path& dir,
                   const Listener& listener);

}  // namespace oraclegs
