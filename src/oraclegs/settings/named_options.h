#pragma once
// The options of a run by their names, for callers other than the command line.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "oraclegs/settings/options.h"

namespace oraclegs {

/// "images", "poses", ...: of all groups, in the order of --help.
std::vector<std::string> RunOptionNames();

/// What an option that a run does not have means.
enum class UnknownOption { kError, kIgnored };

/// Sets options from {"views": 12, "init": "dense", "report": false}: texts as on the command line, numbers, truth
/// values. The others stay. Throws UsageError naming an option that does not exist, or a value that does not fit;
/// ranges are CheckRunOptions' business.
void SetRunOptions(const nlohmann::json& values, UnknownOption unknown, RunOptions* options);

}  // namespace oraclegs
