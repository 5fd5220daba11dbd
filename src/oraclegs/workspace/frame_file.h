#pragma once
// frame.json: how the scene was turned, moved and scaled. A run whose poses were found keeps its frame, also for a
// later version of the program that would choose another.

#include <filesystem>
#include <optional>

#include "oraclegs/scene/frame.h"

namespace oraclegs {

/// The frame of poses that were found: the one in `file`, unless that is missing, damaged or of other poses; else
/// LevelFrame's.
SceneFrame FrameOf(const Scene& scene, const std::filesystem::path& file);

/// What `file` holds; nothing where it is missing or damaged.
std::optional<SceneFrame> ReadFrame(const std::filesystem::path& file);

/// Writes a frame and the poses, before ApplyFrame, that it is of. Throws RunError.
void WriteFrame(const Scene& scene, const SceneFrame& frame, const std::filesystem::path& file);

}  // namespace oraclegs
