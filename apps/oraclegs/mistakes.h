#pragma once
// What the user typed that the command line does not know, in one sentence with the likely meaning.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace oraclegs {

/// Of the words after "oraclegs": an unknown command or option; nothing when there is none. Words after "--" and values
/// are not looked at.
std::optional<std::string> FindMistake(const std::vector<std::string>& words, const CLI::App& app);

/// The same for what CLI11 refuses.
std::string Explain(const CLI::ParseError& error, const CLI::App& app);

}  // namespace oraclegs
