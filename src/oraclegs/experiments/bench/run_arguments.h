#pragma once
// Options of a run as typed text: from suites, methods and users, and as a command line.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "oraclegs/settings/options.h"

namespace oraclegs {

/// {name without dashes, value}, each name once. A flag's value is "" or "true" for on, "false" for off.
using RunArguments = std::vector<std::pair<std::string, std::string>>;

/// Value of an option; null when it is not in the list.
const std::string* FindArgument(const RunArguments& arguments, const std::string& name);
const std::string* FindArgument(RunArguments&& arguments, const std::string& name) = delete;

/// `below`, with the values of `above` replacing its own.
RunArguments Overlaid(RunArguments below, const RunArguments& above);

/// Command line words: {"--views", "12", "--no-report", "--set", "ssim-weight=0.3"}.
std::vector<std::string> ArgumentWords(const RunArguments& arguments);

/// Options of a run; options that are not in the list have their defaults. Throws UsageError for an option that does
/// not exist or a value that does not fit.
RunOptions OptionsOf(const RunArguments& arguments);

/// {name: value} of the options that may change the result: without the machine's, checkpoints and the report.
nlohmann::json ResultArguments(const RunArguments& arguments);

/// "--iterations was 100, now is 200; --views was not given, now is 12"; "" when they are equal.
std::string DifferenceOf(const nlohmann::json& before, const nlohmann::json& now);

}  // namespace oraclegs
