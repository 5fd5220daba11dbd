#pragma once
// What of a result was made with networks whose license forbids commercial use. A stage that used one says so in its
// record ("non_commercial": ["VGGT-1B"]); metrics.json and the PLY repeat it.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "oraclegs/settings/vggt_weights.h"
#include "oraclegs/workspace/workspace.h"

namespace oraclegs {

/// Adds the network to the record of a stage that used it, unless it may be used for anything.
void NoteNetwork(const VggtWeights& weights, nlohmann::json* record);
/// The same by name.
void NoteNonCommercial(const std::string& network, nlohmann::json* record);

/// Names of the networks that finished stages of the workspace noted, each once, ascending.
std::vector<std::string> NonCommercialParts(const WorkspacePaths& workspace);

/// One comment of a PLY for each, and back: comments that say something else are passed over.
std::vector<std::string> LicenseComments(const std::vector<std::string>& parts);
std::vector<std::string> PartsInComments(const std::vector<std::string>& comments);

}  // namespace oraclegs
