#pragma once
// Options of a run by their names (core/option_table.h), for callers other than the command line.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "oraclegs/core/option_table.h"
#include "oraclegs/settings/options.h"

namespace oraclegs {

/// Options that `reconstruct` has, in the order of --help. The options must outlive the table.
OptionTable TableOf(RunOptions* options);

/// Names of all options, "images", "poses", ..., in the order of --help.
std::vector<std::string> RunOptionNames();

/// Handling of names that are no option of a run.
enum class UnknownOption { kError, kIgnored };

/// Sets options from {"views": 12, "init": "dense", "report": false}: texts as on the command line, numbers, truth
/// values. Other options stay unchanged. Throws UsageError naming an option that does not exist or a value that does
/// not fit; CheckRunOptions checks ranges.
void SetRunOptions(const nlohmann::json& values, UnknownOption unknown, RunOptions* options);

/// "--views" or "--set ssim-weight": an option of a run as messages name it; a name that is none as a flag.
std::string RunOptionShown(const std::string& name);

/// Words of the command line that set an option of a run: {"--views", "12"}, {"--no-report"}, {"--set",
/// "ssim-weight=0.3"}. `value` is a text, a number or a truth value.
std::vector<std::string> RunOptionWords(const std::string& name, const nlohmann::json& value);

}  // namespace oraclegs
