#include "mistakes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

std::vector<std::string> CommandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

/// Names of all options, including negated ones.
std::vector<std::string> OptionNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back(name);
  }
  return names;
}

std::string NoSuchOption(const std::string& typed, const CLI::App& command) {
  const std::string name = typed.substr(typed.find_first_not_of('-'));
  std::string nearest = NearestWord(name, OptionNames(command));
  const std::string see = command.get_parent() ? command.get_name() + " --help-all" : "--help";
  return nearest.empty() ? fmt::format("{}: no such option; `oraclegs {}` lists them", typed, see)
                         : fmt::format("{}: no such option; did you mean --{}?", typed, nearest);
}

/// How a setting that is typed as a flag, with the word behind it, is typed right; "" for what is none.
std::string AsSetting(const std::string& typed, const std::string& next, const CommandInfo& command) {
  const size_t equals = typed.find('=');
  const std::string name =
      typed.substr(std::min<size_t>(2, typed.size()), equals == std::string::npos ? equals : equals - 2);
  for (const OptionInfo& setting : command.settings) {
    std::string value = equals == std::string::npos ? next : typed.substr(equals + 1);
    if (setting.negatable && equals == std::string::npos) value = name == setting.name ? "true" : "false";
    const bool is_it = name == setting.name || (setting.negatable && name == "no-" + setting.name);
    if (is_it) return fmt::format("--set {}={}", setting.name, value.empty() ? setting.value : ShellQuoted(value));
  }
  return "";
}

bool IsKnown(const std::string& typed, const CLI::App& command) {
  const bool is_long = typed[1] == '-';
  const std::string name = is_long ? typed.substr(0, typed.find('=')) : typed.substr(0, 2);  // -oDIR is -o DIR
  return command.get_option_no_throw(name) != nullptr;
}

/// "-3" is a number, "-" is a file, "--" ends the options.
bool LooksLikeOption(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && !std::isdigit(static_cast<unsigned char>(word[1])) && word[1] != '.';
}

const CLI::App* CommandNamed(const std::string& name, const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands({})) {
    if (command->get_name() == name) return command;
  }
  return nullptr;
}

}  // namespace

std::optional<std::string> FindMistake(const std::vector<std::string>& words, const CLI::App& app,
                                       const Catalog& commands) {
  const CLI::App* command = &app;
  for (size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "--") return std::nullopt;
    if (LooksLikeOption(word)) {
      if (IsKnown(word, *command)) continue;
      const std::string next = i + 1 < words.size() && !LooksLikeOption(words[i + 1]) ? words[i + 1] : "";
      for (const CommandInfo& info : commands) {
        const std::string meant = info.name == command->get_name() ? AsSetting(word, next, info) : "";
        if (!meant.empty()) return fmt::format("{}: is no flag but an expert's setting; write {}", word, meant);
      }
      return NoSuchOption(word, *command);
    } else if (command == &app) {
      command = CommandNamed(word, app);
      if (!command) {
        const std::vector<std::string> names = CommandNames(app);
        const std::string meant = DidYouMean(word, names);
        return fmt::format("there is no command '{}'{}", word,
                           meant.empty() ? fmt::format("; there are: {}", fmt::join(names, ", ")) : meant);
      }
    }
  }
  return std::nullopt;
}

std::string Explain(const CLI::ParseError& error, const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  if (chosen.empty()) return "name a command; `oraclegs --help` lists them";
  const CLI::App& command = *chosen.front();
  std::string what = error.what();
  const std::string see = fmt::format("; see `oraclegs {} --help`", command.get_name());
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) {
    return fmt::format("{} is missing{}", what.substr(0, what.find(' ')), see);
  }
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr && what.find(" missing") != std::string::npos) {
    return fmt::format("{} needs a value{}", what.substr(0, what.find(':')), see);
  }
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    return fmt::format("not expected: {}{}", fmt::join(command.remaining(), " "), see);
  }
  std::replace(what.begin(), what.end(), '\n', ' ');
  return what + see;
}

}  // namespace oraclegs
