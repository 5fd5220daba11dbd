#pragma once
// The short film that ends a run.

#include <filesystem>

#include "oraclegs/stages/evaluate_stage.h"

namespace oraclegs {

struct OrbitVideo {
  int frames = 96;     ///< 0 = no film
  double seconds = 4;  ///< how long it runs
  int max_side = 960;  ///< pixels; frames of larger views are rendered smaller
};

/// Writes an orbit among the training cameras to `video` (MP4, H.264), in place of what is there, without any other
/// file: the frames go to ffmpeg through a pipe. Returns false without cameras or frames, with a note where ffmpeg is
/// not installed, and with a warning where it fails or the folder cannot be written. Throws Interrupted.
bool WriteOrbitVideo(const Model& model, const std::vector<Camera>& training_cameras,
                     const std::filesystem::path& video, const OrbitVideo& how, const Listener& listener);

/// The same for a run, with its training views at working size, as renders/orbit/video.mp4 of the workspace. Returns
/// its path, empty when there is none.
std::filesystem::path WriteOrbitVideo(const Run& run, const Model& model, const OrbitVideo& how);

}  // namespace oraclegs
