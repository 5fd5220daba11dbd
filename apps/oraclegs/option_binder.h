#pragma once
// Turns the Visit of an options struct (core/options.h) into command-line options and what the help says of them.

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include "command_info.h"
#include "oraclegs/core/nearest_word.h"
#include "oraclegs/core/options.h"

namespace oraclegs {

/// Receives each option that was added, to be remembered; the binder has filled in all but `basic` and `hidden`.
using OptionTaker = std::function<void(OptionInfo)>;

/// Adds each visited field to a command. The struct must outlive the command. CheckOptions checks the ranges, also of
/// what configuration files set.
class OptionBinder {
 public:
  OptionBinder(CLI::App* command, std::string group, OptionTaker taker = {})
      : command_(command), group_(std::move(group)), taker_(std::move(taker)) {}

  template <class T, class... Bounds>
  void operator()(const char* name, T& value, const char* help, const Bounds&... bounds) const {
    OptionInfo info;
    info.name = name;
    info.group = group_;
    info.help = help;
    info.words = WordsOf<T>();
    info.values = WordsText(info.words) + AutoText<T>() + (BoundsText(bounds) + ... + "") + DefaultText(value);
    const bool none = info.values.ends_with("not given by default") || info.values.ends_with("default off");
    if (!none) info.usual = DefaultText(value);
    info.value = ValueName<T>();
    info.letter = LetterOf(info.name);
    if constexpr (std::is_same_v<T, bool>) info.negatable = true, info.default_on = value;
    // An option that is given twice takes the last value: a script can append to a list of options.
    Add(info, &value)->take_last()->group(group_);
    if (taker_) taker_(std::move(info));
  }

 private:
  template <class T>
  static constexpr bool IsText() {
    return std::is_same_v<T, std::string> || std::is_same_v<T, std::filesystem::path>;
  }

  static char LetterOf(const std::string& name) {
    return name == "out" || name == "quiet" || name == "verbose" ? name.front() : '\0';
  }

  /// CLI11's name of the option: "-o,--out".
  static std::string Flags(const OptionInfo& info) {
    return info.letter ? fmt::format("-{},--{}", info.letter, info.name) : "--" + info.name;
  }

  static std::string BoundsText(const Range& range) { return fmt::format("{} .. {}, ", range.low, range.high); }
  static std::string WordsText(const std::vector<std::string>& words) {
    return words.empty() ? "" : fmt::format("{}, ", fmt::join(words, " | "));
  }
  template <class T>
  static std::string AutoText() {
    if constexpr (kIsAuto<T>) return std::is_enum_v<typename T::Value> ? "" : "auto or ";
    return "";
  }

  template <class T>
  static std::vector<std::string> WordsOf() {
    if constexpr (kIsAuto<T>) {
      std::vector<std::string> words = WordsOf<typename T::Value>();
      if (!words.empty()) words.insert(words.begin(), "auto");
      return words;
    } else {
      std::vector<std::string> words;
      if constexpr (std::is_enum_v<T>) {
        for (const auto& row : EnumWords<T>::kWords) words.emplace_back(row.word);
      }
      return words;
    }
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

  template <class T>
  CLI::Option* Add(const OptionInfo& info, T* value) const {
    if constexpr (std::is_same_v<T, bool>) {
      return command_->add_flag(fmt::format("{},!--no-{}", Flags(info), info.name), *value, info.help);
    } else if constexpr (std::is_same_v<T, std::vector<std::string>>) {
      return command_->add_option(Flags(info), *value, info.help);
    } else {
      const auto set = [value, name = info.name, words = info.words](const std::string& text) {
        Set(name, text, words, value);
      };
      return command_->add_option_function<std::string>(Flags(info), set, info.help)->type_name(info.value);
    }
  }

  template <class T>
  static void Set(const std::string& name, const std::string& text, const std::vector<std::string>& words, T* value) {
    try {
      SetOption(name.c_str(), text, value);
    } catch (const UsageError& error) {
      throw UsageError("{}{}", error.what(), DidYouMean(text, words));
    }
  }

  CLI::App* command_;
  std::string group_;
  OptionTaker taker_;
};

}  // namespace oraclegs
