#pragma once
// Short video of an orbit at the end of a run.

#include <filesystem>

#include "oraclegs/stages/evaluate_stage.h"

namespace oraclegs {

struct OrbitVideo {
  int frames = 96;     ///< 0 = no video
  double seconds = 4;  ///< duration
  int max_side = 960;  ///< pixels; frames of larger views are rendered smaller
};

/// Writes an orbit among the training cameras to `video` (MP4, H.264), replacing it. The frames go to ffmpeg through a
/// pipe, without other files. Returns false without cameras or frames, with a note where ffmpeg is not installed, and
/// with a warning where it fails or the folder cannot be written. Throws Interrupted.
bool WriteOrbitVideo(const Model& model, const std::vector<Camera>& training_cameras,
                     const std::filesystem::path& video, const OrbitVideo& how, const Listener& listener);

/// Writes renders/orbit/video.mp4 of a run's workspace, with its training views at working size. Returns its path,
/// empty when there is none.
std::filesystem::path WriteOrbitVideo(const Run& run, const Model& model, const OrbitVideo& how);

}  // namespace oraclegs
