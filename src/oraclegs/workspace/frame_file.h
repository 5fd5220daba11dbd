#pragma once
// frame.json: rotation, translation and scale of the scene in a run. A run whose poses were found keeps its frame, even
// when a later version of the program would choose another.

#include <filesystem>
#include <optional>

#include "oraclegs/scene/frame.h"

namespace oraclegs {

/// Frame of poses that were found: the one in `file`, unless that is missing, damaged or of other poses; else
/// LevelFrame's.
SceneFrame FrameOf(const Scene& scene, const std::filesystem::path& file);

/// Frame in `file`; nullopt where it is missing or damaged.
std::optional<SceneFrame> ReadFrame(const std::filesystem::path& file);

/// Writes a frame and the hash of the poses, as they were before ApplyFrame. Throws RunError.
void WriteFrame(const Scene& scene, const SceneFrame& frame, const std::filesystem::path& file);

}  // namespace oraclegs
