#pragma once
// Options of any number of structs by their names: the one path from a text to a field, for the command line, --set,
// configuration files, presets, saved runs and callers of the library.

#include <deque>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "oraclegs/core/options.h"

namespace oraclegs {

/// Words that an option may be set to; empty for one that takes no words. `rest` is what its declaration has behind the
/// help.
template <class T, class... Rest>
std::vector<std::string> WordsOf(const Rest&... rest) {
  std::vector<std::string> words = WordsIn(rest...);
  if constexpr (kIsAuto<T>) {
    if (words.empty()) words = WordsOf<typename T::Value>();
    if (!words.empty()) words.insert(words.begin(), "auto");
  } else if constexpr (std::is_enum_v<T>) {
    for (const auto& row : EnumWords<T>::kWords) words.emplace_back(row.word);
  }
  return words;
}

/// A field by its name.
class TableOption {
 public:
  TableOption(std::string name, Tier tier, std::function<void(const std::string&)> set, std::vector<std::string> words)
      : name_(std::move(name)), tier_(tier), set_(std::move(set)), words_(std::move(words)) {}

  const std::string& name() const { return name_; }
  Tier tier() const { return tier_; }
  /// True once something has set it.
  bool given() const { return given_; }
  /// True for an option that the command line refuses: only files have it.
  bool of_files_alone() const { return of_files_alone_; }
  void LeaveToFiles() { of_files_alone_ = true; }

  /// Sets the field. Throws UsageError of SetOption, with the nearest word.
  void Set(const std::string& text);
  /// Sets the field from a text, a number or a truth value.
  void Set(const nlohmann::json& value);

 private:
  std::string name_;
  Tier tier_;
  std::function<void(const std::string&)> set_;
  std::vector<std::string> words_;
  bool given_ = false, of_files_alone_ = false;
};

class OptionTable {
 public:
  /// Adds a field, which must outlive the table; `rest` is what its declaration has behind the help.
  template <class T, class... Rest>
  TableOption& Add(const char* name, T* field, const Rest&... rest) {
    const Tier tier = TierIn(rest...);
    return options_.emplace_back(
        name, tier, [=](const std::string& text) { SetOption(name, text, field, tier); }, WordsOf<T>(rest...));
  }
  /// Adds all fields of a struct.
  template <class Options>
  void AddAll(Options* options) {
    Options::Visit(
        *options, [&](const char* name, auto& field, const char*, const auto&... rest) { Add(name, &field, rest...); });
  }

  /// Null when there is none of this name; the first of two.
  TableOption* Find(const std::string& name);
  /// All names, in the order in which they were added.
  std::vector<std::string> Names() const;
  /// True when the option is there and something has set it.
  bool IsGiven(const std::string& name) const;

 private:
  std::deque<TableOption> options_;  // places stay
};

}  // namespace oraclegs
