#pragma once
// Options from files: --config, presets, and those a workspace was made with. The command line wins over --config, that
// over --preset, that over the workspace.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace oraclegs {

/// Sets the command's options that nothing before has set from a TOML file of `option-name = value` lines. Throws
/// UsageError naming the file: it cannot be read, a key is unknown or stands twice, a value does not fit.
void ApplyConfigFile(const std::filesystem::path& file, CLI::App* command);

/// The same from the preset of this name; the message for an unknown one lists those that exist.
void ApplyPreset(const std::string& name, CLI::App* command);

/// The same from a run's saved options; names that the command does not know are passed over.
void ApplySavedOptions(const nlohmann::json& options, const std::filesystem::path& file, CLI::App* command);

}  // namespace oraclegs
