#pragma once
// Lists of training and test views that come with a scene.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/scene/scene.h"
#include "oraclegs/scene/split.h"

namespace oraclegs {

/// The role of each frame of a transforms.json by its train_filenames, test_filenames and val_filenames (Nerfstudio);
/// all kNone when it has none of them. `written`: the frames' file_path. Without test_filenames those of val_filenames
/// test. A view of several lists tests before it validates or trains. Extensions count only where they tell frames
/// apart. A warning, which `source` begins, has the names that no frame has.
std::vector<DeclaredRole> RolesInTransforms(const nlohmann::json& file, const std::vector<std::string>& written,
                                            const std::string& source, const Listener& listener);

/// One note that says how many views the scene's own lists name, when there are any (not of Blender scenes, whose files
/// are the lists).
void ReportDeclaredSplit(const Scene& scene, const std::string& source, const Listener& listener);

/// Names lists of views that lie beside the photos (train.txt, test.txt, split.json, ...) and the options that take
/// them, unless such options are given.
void ReportSplitLists(const Scene& scene, const SplitOptions& options, const Listener& listener);

}  // namespace oraclegs
