#pragma once
// Turns the Visit of an options struct (core/options.h) into flags of the command line, names of a table of options,
// and what the help says of both.

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include "command_info.h"
#include "oraclegs/core/option_table.h"

namespace oraclegs {

/// Receives each option that was added, to be remembered; the binder has filled in all but `basic` and `hidden`.
using OptionTaker = std::function<void(OptionInfo, Tier)>;

/// Adds each visited field to a table, and flags also to a command. The struct and the table must outlive the command.
/// CheckOptions checks the ranges, also of what configuration files set.
class OptionBinder {
 public:
  OptionBinder(CLI::App* command, OptionTable* table, std::string group, OptionTaker taker)
      : command_(command), table_(table), group_(std::move(group)), taker_(std::move(taker)) {}

  template <class T, class... Rest>
  void operator()(const char* name, T& value, const char* help, const Rest&... rest) const {
    OptionInfo info;
    info.name = name;
    info.group = group_;
    info.help = help;
    info.words = WordsOf<T>(rest...);
    info.values = WordsText(info.words) + (info.words.empty() ? AutoText<T>() : "") + BoundsText(RangeIn(rest...)) +
                  DefaultText(value);
    const bool none = info.values.ends_with("not given by default") || info.values.ends_with("default off");
    if (!none) info.usual = DefaultText(value);
    info.value = WordsIn(rest...).empty() ? ValueName<T>() : "WORDS";
    info.letter = LetterOf(info.name);
    if constexpr (std::is_same_v<T, bool>) info.negatable = true, info.default_on = value;
    TableOption& option = table_->Add(name, &value, rest...);
    // An option that is given twice takes the last value: a script can append to a list of options.
    constexpr bool kIsList = std::is_same_v<T, std::vector<std::string>>;
    if (option.tier() == Tier::kFlag) AddFlag(info, &option, kIsList)->take_last()->group(group_);
    taker_(std::move(info), option.tier());
  }

 private:
  static char LetterOf(const std::string& name) {
    return name == "out" || name == "quiet" || name == "verbose" ? name.front() : '\0';
  }

  /// CLI11's name of the option: "-o,--out".
  static std::string Flags(const OptionInfo& info) {
    return info.letter ? fmt::format("-{},--{}", info.letter, info.name) : "--" + info.name;
  }

  static std::string BoundsText(const std::optional<Range>& range) {
    return range ? fmt::format("{} .. {}, ", range->low, range->high) : "";
  }
  static std::string WordsText(const std::vector<std::string>& words) {
    return words.empty() ? "" : fmt::format("{}, ", fmt::join(words, " | "));
  }
  template <class T>
  static std::string AutoText() {
    if constexpr (kIsAuto<T>) return "auto or ";
    return "";
  }

  template <class T>
  static std::string ValueName() {
    if constexpr (kIsAuto<T>) {
      return ValueName<typename T::Value>();
    } else if constexpr (std::is_same_v<T, bool>) {
      return "";
    } else if constexpr (std::is_same_v<T, std::filesystem::path>) {
      return "PATH";
    } else if constexpr (std::is_enum_v<T>) {
      return "WORD";
    } else if constexpr (std::is_integral_v<T>) {
      return "N";
    } else {
      return std::is_floating_point_v<T> ? "X" : "TEXT";
    }
  }

  template <class T>
  static std::string DefaultText(const T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      return value ? "default on" : "default off";
    } else {
      const std::string text = TextOf(ToOptionValue(value));
      return text.empty() ? "not given by default" : "default " + text;
    }
  }

  CLI::Option* AddFlag(const OptionInfo& info, TableOption* option, bool is_list) const {
    if (info.negatable) {
      const auto set = [option](int64_t sign) { option->Set(std::string(sign > 0 ? "true" : "false")); };
      return command_->add_flag_function(fmt::format("{},!--no-{}", Flags(info), info.name), set, info.help);
    }
    if (is_list) {
      const auto add = [option](const std::vector<std::string>& texts) {
        for (const std::string& text : texts) option->Set(text);
      };
      return command_->add_option_function<std::vector<std::string>>(Flags(info), add, info.help);
    }
    const auto set = [option](const std::string& text) { option->Set(text); };
    return command_->add_option_function<std::string>(Flags(info), set, info.help)->type_name(info.value);
  }

  CLI::App* command_;
  OptionTable* table_;
  std::string group_;
  OptionTaker taker_;
};

}  // namespace oraclegs
