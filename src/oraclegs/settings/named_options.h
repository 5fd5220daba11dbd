#pragma once
// Options of a run by their names, for callers other than the command line.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "oraclegs/settings/options.h"

namespace oraclegs {

/// Names of all options, "images", "poses", ..., in the order of --help.
std::vector<std::string> RunOptionNames();

/// Handling of names that are no option of a run.
enum class UnknownOption { kError, kIgnored };

/// Sets options from {"views": 12, "init": "dense", "report": false}: texts as on the command line, numbers, truth
/// values. Other options stay unchanged. Throws UsageError naming an option that does not exist or a value that does
/// not fit; CheckRunOptions checks ranges.
void SetRunOptions(const nlohmann::json& values, UnknownOption unknown, RunOptions* options);

}  // namespace oraclegs
