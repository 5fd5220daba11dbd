#include "config_file.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"
#include "oraclegs/core/nearest_word.h"
#include "oraclegs/core/unique_json.h"
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

CLI::Option* FindOption(const std::string& name, const OptionTargets& targets) {
  for (CLI::App* app : {targets.command, targets.unused}) {
    CLI::Option* option = app ? app->get_option_no_throw("--" + name) : nullptr;
    if (option && option->get_configurable()) return option;
  }
  return nullptr;
}

CLI::Option* RequireOption(const std::string& name, const std::string& source, const OptionTargets& targets) {
  if (CLI::Option* option = FindOption(name, targets)) return option;
  std::vector<std::string> names;
  for (const CLI::App* app : {targets.command, targets.unused}) {
    if (!app) continue;
    for (const CLI::Option* option : app->get_options()) {
      if (option->get_configurable() && !option->get_lnames().empty()) names.push_back(option->get_lnames().front());
    }
  }
  const std::string meant = DidYouMean(name, names);
  throw UsageError(
      "{}: unknown key '{}'{}", source, name,
      meant.empty() ? fmt::format("; `oraclegs {} --help-all` lists the options", targets.command->get_name()) : meant);
}

void Set(CLI::Option* option, const CLI::ConfigItem& item) {
  if (option->count() > 0) return;
  if (option->get_expected_max() == 0) {
    option->add_result(option->get_flag_value(item.name, CLI::ConfigTOML().to_flag(item)));
  } else {
    for (const std::string& value : item.inputs) option->add_result(value);
  }
  option->run_callback();
}

/// Throws UsageError "FILE: ..." when the value does not fit.
void SetFrom(const std::string& source, CLI::Option* option, const CLI::ConfigItem& item) {
  try {
    Set(option, item);
  } catch (const UsageError& error) {
    throw UsageError("{}: {}", source, error.what());
  } catch (const CLI::Error&) {
    throw UsageError("{}: '{}' is not a value for '{}'", source, item.inputs.front(), item.name);
  }
}

void ApplyToml(const std::string& text, const std::string& source, const OptionTargets& targets) {
  std::istringstream lines(text);
  std::set<std::string> seen;
  for (const CLI::ConfigItem& item : CLI::ConfigTOML().from_config(lines)) {
    if (!item.parents.empty()) {
      throw UsageError("{}: sections such as [{}] are not used; write the keys without one", source,
                       item.parents.front());
    }
    CLI::Option* option = RequireOption(item.name, source, targets);
    if (!seen.insert(item.name).second || item.inputs.size() != 1) {
      throw UsageError("{}: '{}' needs exactly one value (put texts in quotes)", source, item.name);
    }
    if (HasOpenQuote(item.inputs.front())) {
      throw UsageError("{}: the text of '{}' has no closing quote (it must not contain #)", source, item.name);
    }
    SetFrom(source, option, item);
  }
}

/// "not given" is saved as an empty text.
bool IsGiven(const json& value) { return value != ""; }

CLI::ConfigItem ItemOf(const std::string& name, const json& value) {
  CLI::ConfigItem item;
  item.name = name;
  item.inputs = {value.is_string() ? value.get<std::string>()
                                   : value.dump(-1, ' ', false, json::error_handler_t::replace)};
  return item;
}

void ApplyJson(const std::string& text, const std::string& source, const OptionTargets& targets) {
  json file;
  try {
    file = ParseUniqueJson(text, source, "configuration");
  } catch (const InputError& error) {
    throw UsageError("{}", error.what());
  }
  if (!file.is_object()) throw UsageError("{}: is no JSON object of options", source);
  const bool of_run = file.contains("options") && file["options"].is_object();
  for (const auto& [name, value] : (of_run ? file["options"] : file).items()) {
    if (of_run && (name == "threads" || name == "device")) continue;  // belong to the machine, not to the run
    CLI::Option* option = of_run ? FindOption(name, targets) : RequireOption(name, source, targets);
    if (!option || !IsGiven(value)) continue;
    if (value.is_structured() || value.is_null()) {
      throw UsageError("{}: '{}' needs one value: a text, a number, true or false", source, name);
    }
    SetFrom(source, option, ItemOf(name, value));
  }
}

bool LooksLikeJson(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string::npos && text[first] == '{';
}

}  // namespace

void ApplyConfigFile(const fs::path& file, const OptionTargets& targets) {
  const std::string text = ReadConfig(file);
  (LooksLikeJson(text) ? ApplyJson : ApplyToml)(text, file.string(), targets);
}

void ApplyPreset(const std::string& name, const OptionTargets& targets) {
  const Preset preset = ReadPreset(name);
  ApplyToml(preset.text, preset.source, targets);
}

void ApplySavedOptions(const json& options, const fs::path& file, const OptionTargets& targets) {
  for (const auto& [name, value] : options.items()) {
    CLI::Option* option = FindOption(name, targets);
    if (!option || !IsGiven(value)) continue;
    const CLI::ConfigItem item = ItemOf(name, value);
    try {
      SetFrom(file.string(), option, item);
    } catch (const UsageError&) {
      throw InputError("{}: '{}' is not a value for '{}'; the file is damaged", file.string(), item.inputs.front(),
                       name);
    }
  }
}

}  // namespace oraclegs
