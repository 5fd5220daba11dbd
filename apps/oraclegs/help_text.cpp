#include "help_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>

namespace oraclegs {
namespace {

constexpr size_t kNameColumn = 30, kLineWidth = 100;
constexpr size_t kFewAdvanced = 3;  // so many more options need no second help

/// Options for beginners, in this order; a command's own options come between the two lists.
constexpr std::array kFirst = {"out", "quality", "preset", "max-size", "eval", "views", "frames", "iterations"};
constexpr std::array kLast = {"view", "seed", "device", "config", "overwrite", "quiet", "help"};

size_t Rank(const OptionInfo& option) {
  const auto first = std::find(kFirst.begin(), kFirst.end(), option.name);
  if (first != kFirst.end()) return static_cast<size_t>(first - kFirst.begin());
  const auto last = std::find(kLast.begin(), kLast.end(), option.name);
  return kFirst.size() + (last == kLast.end() ? 0 : 1 + static_cast<size_t>(last - kLast.begin()));
}

std::string TwoColumns(const std::string& name, const std::string& text) {
  std::string out = "  " + name;
  const std::string indent(kNameColumn, ' ');
  if (out.size() + 2 > kNameColumn) {
    out += "\n" + indent;
  } else {
    out.resize(kNameColumn, ' ');
  }
  size_t column = kNameColumn;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (column > kNameColumn && column + 1 + word.size() > kLineWidth) {
      out += "\n" + indent;
      column = kNameColumn;
    }
    if (column > kNameColumn) out += " ", ++column;
    out += word;
    column += word.size();
  }
  return out + "\n";
}

std::string Line(const OptionInfo& option) { return TwoColumns(NamesOf(option), ExplanationOf(option)); }

template <class LineOf>
std::string Grouped(const std::vector<OptionInfo>& options, const LineOf& line_of) {
  std::string text, group;
  for (const OptionInfo& option : options) {
    if (option.group != group) text += fmt::format("\n{}:\n", group = option.group);
    text += line_of(option);
  }
  return text;
}

std::string Short(std::vector<OptionInfo> options) {
  std::stable_sort(options.begin(), options.end(),
                   [](const OptionInfo& a, const OptionInfo& b) { return Rank(a) < Rank(b); });
  std::string text = "\nOptions:\n";
  for (OptionInfo& option : options) {
    // Ranges, and how to undo what is not the default, are for the long help.
    if (option.words.empty()) option.values = option.usual;
    option.negatable = option.negatable && option.default_on;
    text += Line(option);
  }
  return text;
}

}  // namespace

std::string NamesOf(const OptionInfo& option) {
  std::string names = option.letter ? fmt::format("-{}, --{}", option.letter, option.name) : "--" + option.name;
  if (option.negatable && option.letter == 0) names += ", --no-" + option.name;
  return option.value.empty() ? names : names + " " + option.value;
}

std::string ExplanationOf(const OptionInfo& option) {
  return option.values.empty() ? option.help : fmt::format("{} [{}]", option.help, option.values);
}

std::string UsageOf(const CommandInfo& command) {
  std::string usage = fmt::format("oraclegs {} [OPTIONS]", command.name);
  for (const ArgumentInfo& argument : command.arguments) {
    const std::string name = argument.name + (argument.many ? "..." : "");
    usage += argument.required ? " " + name : fmt::format(" [{}]", name);
  }
  return usage;
}

std::string HelpText(const CommandInfo& command, bool all) {
  std::string text = fmt::format("{}\nUsage: {}\n", command.help, UsageOf(command));
  if (!command.arguments.empty()) text += "\nArguments:\n";
  for (const ArgumentInfo& argument : command.arguments) {
    text += TwoColumns(argument.name + " " + argument.value + (argument.many ? "..." : ""), argument.help);
  }
  std::vector<OptionInfo> shown, basic;
  for (const OptionInfo& option : command.options) {
    if (option.hidden) continue;
    shown.push_back(option);
    if (option.basic) basic.push_back(option);
  }
  if (all || shown.size() - basic.size() <= kFewAdvanced) {
    text += Grouped(shown, Line);
    const bool has_settings = std::any_of(command.settings.begin(), command.settings.end(),
                                          [](const OptionInfo& setting) { return !setting.hidden; });
    if (has_settings) text += "\nExperts' settings, by --set NAME=VALUE: oraclegs help settings\n";
  } else {
    text += Short(basic);
    text += fmt::format("\n{} more options: oraclegs {} --help-all\n", shown.size() - basic.size(), command.name);
  }
  return text + fmt::format("\nExample:\n  {}\n", command.example);
}

std::string SettingsText(const CommandInfo& command) {
  const auto line = [](const OptionInfo& setting) {
    const std::string value = setting.negatable ? "true|false" : setting.value;
    return TwoColumns(fmt::format("{}={}", setting.name, value), ExplanationOf(setting));
  };
  return "What only experiments set, by --set NAME=VALUE, by a line `NAME = VALUE` of a file of --config, or from "
         "Python\nUsage: oraclegs COMMAND --set NAME=VALUE\n" +
         Grouped(command.settings, line) + "\nExample:\n  oraclegs reconstruct photos/ -o out/ --set ssim-weight=0.3\n";
}

std::string OverviewText(const Catalog& commands) {
  std::string text =
      "OracleGS: a few photos become a 3D Gaussian splat, on a CPU or an NVIDIA GPU.\n"
      "Usage: oraclegs COMMAND [OPTIONS]\n";
  std::string group;
  for (const CommandInfo& command : commands) {
    if (command.group != group) text += fmt::format("\n{}:\n", group = command.group);
    text += TwoColumns(command.name, command.help);
  }
  return text + "\nOptions:\n" +
         TwoColumns("-h, --help", "Print this help; `oraclegs help COMMAND` explains a command") +
         TwoColumns("--version", "Print the version, and what this program was built with and finds here") +
         "\nStart with:\n"
         "  oraclegs demo\n"
         "  oraclegs reconstruct photos/ -o out/\n";
}

}  // namespace oraclegs
