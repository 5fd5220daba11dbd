#pragma once
// Runs of one scene that differ in a few options need not find the same depth again.

#include <filesystem>
#include <vector>

#include "oraclegs/workspace/workspace.h"

namespace oraclegs {

// Each of these copies folders, and the records of the stages that filled them, from the first of `donors` that has
// them (workspaces of the same scene, the likeliest first). Nothing happens where `workspace` already has some of its
// own. Whether what was copied fits is for the stages to check, as after any change of options: each compares its key.
// A donor that is missing, damaged or in use is passed over, and what cannot be copied is found anew.

/// Poses of images without any.
void TakeOverRegistration(Workspace* workspace, const std::vector<std::filesystem::path>& donors);

/// Poses, points and depth.
void TakeOverGeometry(Workspace* workspace, const std::vector<std::filesystem::path>& donors);

/// Proposals, proxy models and confidence.
void TakeOverProposals(Workspace* workspace, const std::vector<std::filesystem::path>& donors);

}  // namespace oraclegs
