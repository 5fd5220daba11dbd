#pragma once
// Turns the Visit of an options struct (core/options.h) into command-line options with their help.

#include <CLI/CLI.hpp>
#include <string>
#include <type_traits>

#include "oraclegs/core/options.h"

namespace oraclegs {

template <class T>
inline constexpr bool kIsAutoNumber = false;
template <class T>
inline constexpr bool kIsAutoNumber<Auto<T>> = std::is_arithmetic_v<T>;

/// Adds each visited field to a command. The struct must outlive the command. The help shows ranges, words and
/// defaults; CheckOptions checks the ranges, also of what configuration files set.
class OptionBinder {
 public:
  OptionBinder(CLI::App* command, std::string group) : command_(command), group_(std::move(group)) {}

  template <class T, class... Bounds>
  void operator()(const char* name, T& value, const char* help, const Bounds&... bounds) const {
    const std::string text =
        fmt::format("{} [{}{}{}]", help, WordsText<T>(), (BoundsText(bounds) + ... + ""), DefaultText(value));
    // An option that is given twice takes the last value: a script can append to a list of options.
    Add(name, value, text)->take_last()->group(group_);
  }

 private:
  static std::string Flags(const std::string& name) {
    if (name == "out") return "-o,--out";
    if (name == "quiet" || name == "verbose") return fmt::format("-{},--{}", name.front(), name);
    return "--" + name;
  }
  static std::string BoundsText(const Range& range) { return fmt::format("{} .. {}, ", range.low, range.high); }

  template <class T>
  static std::string WordsText() {
    if constexpr (kIsAuto<T>) {
      return std::is_enum_v<typename T::Value> ? "auto | " + WordsText<typename T::Value>() : "auto or ";
    } else if constexpr (std::is_enum_v<T>) {
      return AllWords<T>(" | ") + ", ";
    } else {
      return "";
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

  /// Numbers are CLI11's to read, all other texts ours: their errors name the words that exist.
  template <class T>
  CLI::Option* Add(const std::string& name, T& value, const std::string& help) const {
    if constexpr (std::is_same_v<T, bool>) {
      return command_->add_flag(fmt::format("{},!--no-{}", Flags(name), name), value, help);
    } else if constexpr (std::is_enum_v<T> || kIsAuto<T> || std::is_same_v<T, std::filesystem::path>) {
      return command_
          ->add_option_function<std::string>(
              Flags(name), [&value, name](const std::string& text) { SetOption(name.c_str(), text, &value); }, help)
          ->type_name(std::is_same_v<T, std::filesystem::path> ? "PATH"
                      : kIsAutoNumber<T>                       ? "FLOAT"
                                                               : "TEXT");
    } else {
      return command_->add_option(Flags(name), value, help);
    }
  }

  CLI::App* command_;
  std::string group_;
};

}  // namespace oraclegs
