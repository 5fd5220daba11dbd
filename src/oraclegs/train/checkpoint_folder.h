#pragma once
// The folder that a run keeps its checkpoints in, and what a message says of it.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace oraclegs {

/// DIR/iteration_0003000.safetensors
std::filesystem::path CheckpointPath(const std::filesystem::path& dir, int64_t iteration);

/// The checkpoints of a folder ("iteration_0003000.safetensors"), the newest first.
std::vector<std::filesystem::path> FindCheckpoints(const std::filesystem::path& dir);

/// The newest of them, nullopt when there is none.
std::optional<std::filesystem::path> NewestCheckpoint(const std::filesystem::path& dir);

/// Removes what a run that has just saved `iteration` needs no more: all but the two newest up to there, those of
/// later iterations, which an abandoned run has left and NewestCheckpoint would mistake for this one's, and temporary
/// files of runs that were killed. No other run may be writing to the folder.
void RemoveOldCheckpoints(const std::filesystem::path& dir, int64_t iteration);

/// For the message of a run that memory ended: what is left, and how to go on. `dir` may be empty: nothing is saved.
std::string WhereToContinue(const std::filesystem::path& dir);

/// For that of a run that diverged, which it would do again from there with the same options.
std::string WhatIsSaved(const std::filesystem::path& dir);

}  // namespace oraclegs
