#pragma once
// Parts of a result made with networks whose license forbids commercial use. A stage that used one notes it in its
// record ("non_commercial": ["VGGT-1B"]); metrics.json and the PLY repeat it.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "oraclegs/settings/vggt_weights.h"
#include "oraclegs/workspace/workspace.h"

namespace oraclegs {

/// Adds the network to the record of a stage that used it, unless its license allows commercial use.
void NoteNetwork(const VggtWeights& weights, nlohmann::json* record);
/// Adds a network by its name.
void NoteNonCommercial(const std::string& network, nlohmann::json* record);

/// Names of the networks that finished stages of the workspace noted, each once, ascending.
std::vector<std::string> NonCommercialParts(const WorkspacePaths& workspace);

/// PLY comments, one for each name, and names in such comments; other comments are ignored.
std::vector<std::string> LicenseComments(const std::vector<std::string>& parts);
std::vector<std::string> PartsInComments(const std::vector<std::string>& comments);

}  // namespace oraclegs
