#pragma once
// Options from files: --config, presets, and those a workspace was made with. The command line wins over --config, that
// over --preset, that over the workspace.

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "oraclegs/core/option_table.h"
#include "oraclegs/experiments/bench/run_arguments.h"

namespace oraclegs {

/// Sets the options that nothing before has set from a file: TOML of `option-name = value` lines, or JSON, which is the
/// options.json of a run (of which options that the command does not know, --threads and --device are passed over) or
/// an object of options. Throws UsageError naming the file: it cannot be read, a key is unknown or stands twice, a
/// value does not fit. `command` is the command whose options they are, for messages.
void ApplyConfigFile(const std::filesystem::path& file, const std::string& command, OptionTable* options);

/// Sets options from the preset of this name; the message for an unknown one lists the presets. Returns the values of
/// those that were set before.
std::map<std::string, std::string> ApplyPreset(const std::string& name, const std::string& command,
                                               OptionTable* options);

/// Options of a run, bound to `table`, that something has set.
RunArguments GivenArguments(const OptionTable& table, const RunOptions& options);

/// Options of a run that the preset of this name sets.
RunArguments PresetArguments(const std::string& name);

/// Sets options from a run's saved ones; names that the command does not know are ignored. Throws InputError naming the
/// file when a value does not fit.
void ApplySavedOptions(const nlohmann::json& saved, const std::filesystem::path& file, OptionTable* options);

}  // namespace oraclegs
