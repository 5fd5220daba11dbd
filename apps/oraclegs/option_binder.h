#pragma once
// Turns the Visit of an options struct (core/options.h) into command-line options with their help.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <string>
#include <type_traits>

#include "oraclegs/core/options.h"

namespace oraclegs {

/// Adds each visited field to a command. The struct must outlive the command. Ranges and words are told in the help and
/// checked by CheckOptions, which sees configuration files too.
class OptionBinder {
 public:
  OptionBinder(CLI::App* command, std::string group) : command_(command), group_(std::move(group)) {}

  template <class T, class... Bounds>
  void operator()(const char* name, T& value, const char* help, const Bounds&... bounds) const {
    const std::string text = fmt::format("{} [{}{}]", help, (BoundsText(bounds) + ... + ""), DefaultText(value));
    // Said twice, the last one holds: a script can append to a list of options.
    Add(name, value, text)->take_last()->group(group_);
  }

 private:
  static std::string Flags(const std::string& name) {
    if (name == "out") return "-o,--out";
    if (name == "quiet" || name == "verbose") return fmt::format("-{},--{}", name.front(), name);
    return "--" + name;
  }
  static std::string BoundsText(const Range& range) { return fmt::format("{} .. {}, ", range.low, range.high); }
  static std::string BoundsText(const Choice& choice) { return fmt::format("{}, ", fmt::join(choice.words, " | ")); }

  template <class T>
  static std::string DefaultText(const T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      return value ? "default on" : "default off";
    } else if constexpr (std::is_arithmetic_v<T>) {
      return fmt::format("default {:.6}", static_cast<double>(value));
    } else {
      const std::string text = std::filesystem::path(value).string();
      return text.empty() ? "not given by default" : "default " + text;
    }
  }

  template <class T>
  CLI::Option* Add(const std::string& name, T& value, const std::string& help) const {
    if constexpr (std::is_same_v<T, bool>) {
      return command_->add_flag(fmt::format("{},!--no-{}", Flags(name), name), value, help);
    } else if constexpr (std::is_same_v<T, std::filesystem::path>) {
      return command_
          ->add_option_function<std::string>(
              Flags(name), [&value](const std::string& text) { value = text; }, help)
          ->type_name("PATH");
    } else {
      return command_->add_option(Flags(name), value, help);
    }
  }

  CLI::App* command_;
  std::string group_;
};

}  // namespace oraclegs
