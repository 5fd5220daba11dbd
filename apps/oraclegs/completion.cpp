#include "completion.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <vector>

#include "oraclegs/core/error.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

std::string OptionNames(const CommandInfo& command) {
  std::string names;
  for (const OptionInfo& option : command.options) {
    if (option.hidden) continue;
    names += fmt::format("{}--{}", names.empty() ? "" : " ", option.name);
    if (option.negatable && option.default_on) names += " --no-" + option.name;
  }
  return names;
}

/// Words for the first argument of completion, help and models; "" for other commands.
std::string ArgumentWords(const CommandInfo& command, const Catalog& commands) {
  if (command.name == "completion") return "bash zsh fish";
  if (command.name == "models") return "list fetch check convert";
  if (command.name != "help") return "";
  std::vector<std::string> names = {"settings"};
  for (const CommandInfo& other : commands) names.push_back(other.name);
  return fmt::format("{}", fmt::join(names, " "));
}

/// Words of each option, by its name; the first command with an option decides.
std::map<std::string, std::string> WordsOfOptions(const Catalog& commands) {
  std::map<std::string, std::string> words;
  for (const CommandInfo& command : commands) {
    for (const OptionInfo& option : command.options) {
      if (!option.words.empty()) words.try_emplace(option.name, fmt::format("{}", fmt::join(option.words, " ")));
    }
  }
  return words;
}

bool IsPath(const OptionInfo& option) { return option.value == "PATH" || option.value == "FILE"; }

/// "--name|--other": options whose value is neither a path nor a word, for which nothing is offered.
std::string OtherValues(const Catalog& commands) {
  std::vector<std::string> names;
  for (const CommandInfo& command : commands) {
    for (const OptionInfo& option : command.options) {
      if (option.value.empty() || IsPath(option) || !option.words.empty()) continue;
      if (std::find(names.begin(), names.end(), "--" + option.name) == names.end()) names.push_back("--" + option.name);
    }
  }
  return fmt::format("{}", fmt::join(names, "|"));
}

std::string Bash(const Catalog& commands) {
  std::vector<std::string> names;
  std::string cases, values;
  for (const CommandInfo& command : commands) {
    names.push_back(command.name);
    cases += fmt::format("    {}) options='{}'; words='{}' ;;\n", command.name, OptionNames(command),
                         ArgumentWords(command, commands));
  }
  for (const auto& [name, words] : WordsOfOptions(commands)) {
    values += fmt::format("    --{}) COMPREPLY=($(compgen -W '{}' -- \"$cur\")); return ;;\n", name, words);
  }
  return fmt::format(R"(# bash completion of oraclegs, printed by `oraclegs completion bash`.
_oraclegs() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD-1]}} options='' words=''
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    COMPREPLY=($(compgen -W '{} --help --version' -- "$cur"))
    return
  fi
  case $prev in
{}    {}) return ;;
  esac
  case ${{COMP_WORDS[1]}} in
{}  esac
  if [[ $cur == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$cur"))
  elif [[ $words ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$cur"))
  else
    compopt -o filenames 2>/dev/null
    local IFS=$'\n'
    COMPREPLY=($(compgen -f -- "$cur"))
  fi
}}
complete -F _oraclegs oraclegs
)",
                     fmt::join(names, " "), values, OtherValues(commands), cases);
}

/// In single quotes, for zsh's _arguments and fish; the first sentence is enough.
std::string Summary(const std::string& help) {
  std::string text = help.substr(0, help.find_first_of(";:"));
  for (char& c : text) {
    if (c == '\'' || c == '[' || c == ']' || c == '`') c = ' ';
  }
  return text;
}

std::string ZshOption(const OptionInfo& option) {
  std::string value;
  if (!option.words.empty()) {
    value = fmt::format(":{}:({})", option.name, fmt::join(option.words, " "));
  } else if (IsPath(option)) {
    value = fmt::format(":{}:_files", option.name);
  } else if (!option.value.empty()) {
    value = fmt::format(":{}: ", option.name);
  }
  return fmt::format("      '--{}[{}]{}' \\\n", option.name, Summary(option.help), value);
}

std::string Zsh(const Catalog& commands) {
  std::string list, cases;
  for (const CommandInfo& command : commands) {
    list += fmt::format("    '{}:{}'\n", command.name, Summary(command.help));
    cases += fmt::format("    {})\n      _arguments \\\n", command.name);
    for (const OptionInfo& option : command.options) {
      if (!option.hidden) cases += ZshOption(option);
    }
    const std::string words = ArgumentWords(command, commands);
    cases += words.empty() ? "      '*:file:_files' ;;\n" : fmt::format("      '*:word:({})' ;;\n", words);
  }
  return fmt::format(R"(#compdef oraclegs
# zsh completion of oraclegs, printed by `oraclegs completion zsh`.
_oraclegs() {{
  local -a commands
  commands=(
{}  )
  if ((CURRENT == 2)); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  ((CURRENT--))
  case $command in
{}  esac
}}
if [ "$funcstack[1]" = "_oraclegs" ]; then
  _oraclegs "$@"
else
  compdef _oraclegs oraclegs
fi
)",
                     list, cases);
}

std::string Fish(const Catalog& commands) {
  std::string text =
      "# fish completion of oraclegs, printed by `oraclegs completion fish`.\n"
      "complete -c oraclegs -n __fish_use_subcommand -f -l version -d 'Print the version'\n";
  for (const CommandInfo& command : commands) {
    text += fmt::format("complete -c oraclegs -n __fish_use_subcommand -f -a {} -d '{}'\n", command.name,
                        Summary(command.help));
    const std::string here = fmt::format("complete -c oraclegs -n '__fish_seen_subcommand_from {}'", command.name);
    const std::string words = ArgumentWords(command, commands);
    if (!words.empty()) text += fmt::format("{} -f -a '{}'\n", here, words);
    for (const OptionInfo& option : command.options) {
      if (option.hidden) continue;
      text += fmt::format("{} -l {}", here, option.name);
      if (option.letter) text += fmt::format(" -s {}", option.letter);
      if (!option.words.empty()) {
        text += fmt::format(" -x -a '{}'", fmt::join(option.words, " "));
      } else if (!option.value.empty()) {
        text += IsPath(option) ? " -r -F" : " -x";
      }
      text += fmt::format(" -d '{}'\n", Summary(option.help));
    }
  }
  return text;
}

}  // namespace

std::string CompletionOf(const std::string& shell, const Catalog& commands) {
  if (shell == "bash") return Bash(commands);
  if (shell == "zsh") return Zsh(commands);
  if (shell == "fish") return Fish(commands);
  throw UsageError("there is no completion for '{}', only for bash, zsh and fish{}", shell,
                   DidYouMean(shell, {"bash", "zsh", "fish"}));
}

}  // namespace oraclegs
