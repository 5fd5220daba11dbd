#pragma once
// frame.json: how the poses that were found were turned, moved and scaled. A run keeps its frame, also for a later
// version of the program that would choose another.

#include <filesystem>
#include <optional>

#include "oraclegs/scene/frame.h"

namespace oraclegs {

/// The frame of these poses: the one in `file`, unless that is missing, damaged or of other poses; else LevelFrame's.
SceneFrame FrameOf(const Scene& scene, const std::filesystem::path& file);

/// What `file` holds; nothing where it is missing or damaged.
std::optional<SceneFrame> ReadFrame(const std::filesystem::path& file);

/// Writes the frame that FrameOf found for these poses. Throws RunError.
void WriteFrame(const Scene& scene, const SceneFrame& frame, const std::filesystem::path& file);

}  // namespace oraclegs
