#pragma once
// The folder of a run's checkpoints, and the messages about it.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace oraclegs {

/// Path DIR/iteration_0003000.safetensors of an iteration's checkpoint.
std::filesystem::path CheckpointPath(const std::filesystem::path& dir, int64_t iteration);

/// The checkpoints of a folder ("iteration_0003000.safetensors"), the newest first.
std::vector<std::filesystem::path> FindCheckpoints(const std::filesystem::path& dir);

/// The newest checkpoint of a folder, nullopt when there is none.
std::optional<std::filesystem::path> NewestCheckpoint(const std::filesystem::path& dir);

/// Removes checkpoints that a run that has just saved `iteration` no longer needs: all but the two newest up to there,
/// later ones, which an abandoned run has left and NewestCheckpoint would mistake for this run's, and temporary files
/// of killed runs. No other run may be writing to the folder.
void RemoveOldCheckpoints(const std::filesystem::path& dir, int64_t iteration);

/// Message of a run that ran out of memory: the last checkpoint and how to continue from it. An empty `dir` means that
/// nothing is saved.
std::string WhereToContinue(const std::filesystem::path& dir);

/// Message of a run that diverged: the last checkpoint. It does not suggest continuing, which would diverge again.
std::string WhatIsSaved(const std::filesystem::path& dir);

}  // namespace oraclegs
