#include "config_file.h"

#include <algorithm>
#include <cstdlib>
#include <set>
#include <sstream>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/files.h"

namespace oraclegs {
namespace {

namespace fs = std::filesystem;

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

void Set(CLI::Option* option, const CLI::ConfigItem& item, const CLI::Config& config) {
  if (option->count() > 0) return;
  if (option->get_expected_max() == 0) {
    option->add_result(option->get_flag_value(item.name, config.to_flag(item)));
  } else {
    for (const std::string& value : item.inputs) option->add_result(value);
  }
  option->run_callback();
}

CLI::Option* FindOption(const std::string& name, CLI::App* command) {
  CLI::Option* option = command->get_option_no_throw("--" + name);
  return option && option->get_configurable() ? option : nullptr;
}

std::vector<fs::path> PresetFolders() {
  std::vector<fs::path> folders;
  if (const char* own = std::getenv("ORACLEGS_PRESETS")) folders.emplace_back(own);
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) folders.push_back(program.parent_path().parent_path() / "share" / "oraclegs" / "presets");
  folders.emplace_back(ORACLEGS_PRESET_DIR);
  return folders;
}

}  // namespace

void ApplyConfigFile(const fs::path& file, CLI::App* command) {
  const CLI::ConfigTOML toml;
  std::istringstream text(ReadConfig(file));
  std::set<std::string> seen;
  for (CLI::ConfigItem& item : toml.from_config(text)) {
    if (!item.parents.empty()) {
      throw UsageError("{}: sections such as [{}] are not used; write the keys without one", file.string(),
                       item.parents.front());
    }
    CLI::Option* option = FindOption(item.name, command);
    if (!option) {
      throw UsageError("{}: unknown key '{}'; `oraclegs {} --help` lists the options", file.string(), item.name,
                       command->get_name());
    }
    if (!seen.insert(item.name).second || item.inputs.size() != 1) {
      throw UsageError("{}: '{}' needs exactly one value (put texts in quotes)", file.string(), item.name);
    }
    if (HasOpenQuote(item.inputs.front())) {
      throw UsageError("{}: the text of '{}' has no closing quote (it must not contain #)", file.string(), item.name);
    }
    try {
      Set(option, item, toml);
    } catch (const UsageError& error) {
      throw UsageError("{}: {}", file.string(), error.what());
    } catch (const CLI::Error&) {
      throw UsageError("{}: '{}' is not a value for '{}'", file.string(), item.inputs.front(), item.name);
    }
  }
}

void ApplyPreset(const std::string& name, CLI::App* command) {
  std::set<std::string> known;
  for (const fs::path& folder : PresetFolders()) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      if (entry.path().extension() != ".toml") continue;
      if (entry.path().stem() == name) return ApplyConfigFile(entry.path(), command);
      known.insert(entry.path().stem().string());
    }
  }
  throw UsageError("--preset {} does not exist; there are: {}", name, fmt::join(known, ", "));
}

void ApplySavedOptions(const nlohmann::json& options, const fs::path& file, CLI::App* command) {
  const CLI::ConfigTOML toml;
  for (const auto& [name, value] : options.items()) {
    CLI::Option* option = FindOption(name, command);
    if (!option || value == "") continue;  // an empty text is what "not given" is saved as
    CLI::ConfigItem item;
    item.name = name;
    item.inputs = {value.is_string() ? value.get<std::string>() : value.dump()};
    const auto refuse = [&] {
      throw InputError("{}: '{}' is not a value for '{}'; the file is damaged", file.string(), item.inputs.front(),
                       name);
    };
    try {
      Set(option, item, toml);
    } catch (const UsageError&) {
      refuse();
    } catch (const CLI::Error&) {
      refuse();
    }
  }
}

}  // namespace oraclegs
