#pragma once
// Options from files: --config, presets, and those a workspace was made with. The command line wins over --config, that
// over --preset, that over the workspace.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace oraclegs {

/// Where an option of a file goes: to the command's own option, else to one that files alone may set.
struct OptionTargets {
  CLI::App* command;
  CLI::App* unused = nullptr;
};

/// Sets the options that nothing before has set from a file: TOML of `option-name = value` lines, or JSON, which is the
/// options.json of a run (of which options that the command does not know, --threads and --device are passed over) or
/// an object of options. Throws UsageError naming the file: it cannot be read, a key is unknown or stands twice, a
/// value does not fit.
void ApplyConfigFile(const std::filesystem::path& file, const OptionTargets& targets);

/// Sets options from the preset of this name; the message for an unknown one lists the presets.
void ApplyPreset(const std::string& name, const OptionTargets& targets);

/// Sets options from a run's saved ones; names that the command does not know are ignored. Throws InputError naming the
/// file when a value does not fit.
void ApplySavedOptions(const nlohmann::json& options, const std::filesystem::path& file, const OptionTargets& targets);

}  // namespace oraclegs
