#pragma once
// sfm/refined.json: poses of the training views that stage "poses" corrected.

#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/camera/camera.h"
#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Writes the poses of cameras, in the coordinates of the run. Throws RunError.
void WriteRefinedPoses(const std::filesystem::path& file, const std::vector<std::string>& names,
                       const std::vector<Camera>& cameras);

/// Gives the run the poses of these cameras of its training views, whatever poses it has; other views of the scene
/// follow the given ones (Following). Views that are loaded change with it.
void UsePoses(Run* run, const std::vector<Camera>& training);

/// UsePoses of sfm/refined.json where stage "poses" refined them; nothing otherwise. Throws InputError naming the file
/// when it is damaged or of other views.
void UseRefinedPoses(Run* run);

/// UseRefinedPoses of a run that goes on, where stage "poses" is up to date: stages after it are, and have used them.
/// Damaged ones are made again.
void TakeRefinedPoses(Run* run);

}  // namespace oraclegs
