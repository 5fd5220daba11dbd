#include "config_file.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"
#include "oraclegs/settings/named_options.h"
#include "presets.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr uint64_t kMaxConfigBytes = 1 << 20;

std::string ReadConfig(const fs::path& file) {
  try {
    return ReadFile(file, kMaxConfigBytes);
  } catch (const Error& e) {
    throw UsageError("{}", e.what());
  }
}

bool HasOpenQuote(const std::string& value) {
  return !value.empty() && (value.front() == '"' || value.front() == '\'');
}

/// Options of a command, and a file that sets them.
struct Source {
  std::string name;  ///< name of the file, for messages
  std::string command;
  OptionTable* options;
};

TableOption* RequireOption(const std::string& name, const Source& source) {
  if (TableOption* option = source.options->Find(name)) return option;
  const std::string meant = DidYouMean(name, source.options->Names());
  throw UsageError(
      "{}: unknown key '{}'{}", source.name, name,
      meant.empty()
          ? fmt::format("; `oraclegs {} --help-all` and `oraclegs help settings` list the options", source.command)
          : meant);
}

/// Sets an option that nothing before has set; returns whether it did. Throws UsageError "FILE: ..." when the value
/// does not fit.
bool SetFrom(const std::string& source, TableOption* option, const json& value) {
  if (option->given()) return false;
  try {
    option->Set(value);
  } catch (const UsageError& error) {
    throw UsageError("{}: {}", source, error.what());
  }
  return true;
}

/// Returns the values of options that were set before.
std::map<std::string, std::string> ApplyToml(const std::string& text, const Source& source) {
  std::map<std::string, std::string> overruled;
  std::istringstream lines(text);
  std::set<std::string> seen;
  for (const CLI::ConfigItem& item : CLI::ConfigTOML().from_config(lines)) {
    if (!item.parents.empty()) {
      throw UsageError("{}: sections such as [{}] are not used; write the keys without one", source.name,
                       item.parents.front());
    }
    TableOption* option = RequireOption(item.name, source);
    if (!seen.insert(item.name).second || item.inputs.size() != 1) {
      throw UsageError("{}: '{}' needs exactly one value (put texts in quotes)", source.name, item.name);
    }
    if (HasOpenQuote(item.inputs.front())) {
      throw UsageError("{}: the text of '{}' has no closing quote (it must not contain #)", source.name, item.name);
    }
    if (!SetFrom(source.name, option, item.inputs.front())) overruled[item.name] = item.inputs.front();
  }
  return overruled;
}

void ApplyJson(const std::string& text, const Source& source) {
  json file;
  try {
    file = ParseUniqueJson(text, source.name, "configuration");
  } catch (const InputError& error) {
    throw UsageError("{}", error.what());
  }
  if (!file.is_object()) throw UsageError("{}: is no JSON object of options", source.name);
  const bool of_run = file.contains("options") && file["options"].is_object();
  for (const auto& [name, value] : (of_run ? file["options"] : file).items()) {
    if (of_run && (name == "threads" || name == "device")) continue;  // belong to the machine, not to the run
    TableOption* option = of_run ? source.options->Find(name) : RequireOption(name, source);
    if (option) SetFrom(source.name, option, value);
  }
}

bool LooksLikeJson(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string::npos && text[first] == '{';
}

}  // namespace

void ApplyConfigFile(const fs::path& file, const std::string& command, OptionTable* options) {
  const std::string text = ReadConfig(file);
  const Source source{file.string(), command, options};
  if (LooksLikeJson(text)) return ApplyJson(text, source);
  ApplyToml(text, source);
}

std::map<std::string, std::string> ApplyPreset(const std::string& name, const std::string& command,
                                               OptionTable* options) {
  const Preset preset = ReadPreset(name);
  return ApplyToml(preset.text, {preset.source, command, options});
}

RunArguments GivenArguments(const OptionTable& table, const RunOptions& options) {
  RunArguments given;
  const json values = RunOptionsToJson(options);
  for (const auto& [name, value] : values.items()) {
    if (table.IsGiven(name)) given.emplace_back(name, value.is_string() ? value.get<std::string>() : value.dump());
  }
  return given;
}

RunArguments PresetArguments(const std::string& name) {
  RunOptions options;
  OptionTable table = TableOf(&options);
  ApplyPreset(name, "reconstruct", &table);
  return GivenArguments(table, options);
}

void ApplySavedOptions(const json& saved, const fs::path& file, OptionTable* options) {
  for (const auto& [name, value] : saved.items()) {
    TableOption* option = options->Find(name);
    if (!option) continue;
    try {
      SetFrom(file.string(), option, value);
    } catch (const UsageError& error) {
      throw InputError("{}; the file is damaged", error.what());
    }
  }
}

}  // namespace oraclegs
