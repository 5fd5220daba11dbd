#pragma once
// Mistakes on the command line, in one sentence with the likely meaning.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "command_info.h"

namespace oraclegs {

/// Unknown command or option among the words after "oraclegs"; nullopt when there is none. Words after "--" and values
/// are not checked. `commands` describes those of `app`.
std::optional<std::string> FindMistake(const std::vector<std::string>& words, const CLI::App& app,
                                       const Catalog& commands);

/// Explains an error of CLI11.
std::string Explain(const CLI::ParseError& error, const CLI::App& app);

}  // namespace oraclegs
