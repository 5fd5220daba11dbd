#pragma once
// An option is declared once, in the Visit of its struct; the command line, the TOML file, --help, the range check and
// the options saved with a run all read that list.
//
//   struct SplitOptions {
//     int views = 0;
//     template <class Self, class V> static void Visit(Self& self, V&& visit) {
//       visit("views", self.views, "Training views to pick, 0 = all", Range{0, 100000});
//     }
//   };
//
// A field is a bool, a number, a text, a list of texts, a path, an enumeration with words (enum_words.h), or Auto of a
// number or an enumeration: "auto" decides for the user. Tier::kSetting behind the help makes the option an expert's
// setting: no flag, but --set NAME=VALUE; all else is the same for both.

#include <charconv>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "oraclegs/core/enum_words.h"
#include "oraclegs/core/error.h"

namespace oraclegs {

/// A value of the user's, or nothing: the program decides ("auto").
template <class T>
class Auto {
 public:
  using Value = T;

  Auto() = default;
  Auto(T value) : value_(value) {}  // NOLINT: an option is assigned like a plain value

  bool is_auto() const { return !value_; }
  /// The value that was set; undefined for an automatic one.
  T value() const { return *value_; }
  T ValueOr(T decided) const { return value_.value_or(decided); }
  bool operator==(const Auto&) const = default;

 private:
  std::optional<T> value_;
};

template <class T>
inline constexpr bool kIsAuto = false;
template <class T>
inline constexpr bool kIsAuto<Auto<T>> = true;

/// Inclusive bounds of a number.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

/// How the command line names an option: --NAME VALUE, or --set NAME=VALUE.
enum class Tier { kFlag, kSetting };

/// "--views" or "--set ssim-weight": an option as messages name it.
std::string OptionShown(Tier tier, const std::string& name);

/// Tier among the words of a declaration behind the help; a flag when none says otherwise.
template <class... Rest>
constexpr Tier TierIn(const Rest&... rest) {
  Tier tier = Tier::kFlag;
  [[maybe_unused]] const auto look = [&](const auto& one) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(one)>, Tier>) tier = one;
  };
  (look(rest), ...);
  return tier;
}

/// Range among the words of a declaration behind the help.
template <class... Rest>
constexpr std::optional<Range> RangeIn(const Rest&... rest) {
  std::optional<Range> range;
  [[maybe_unused]] const auto look = [&](const auto& one) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(one)>, Range>) range = one;
  };
  (look(rest), ...);
  return range;
}

/// The value of a field, for files.
using OptionValue = std::variant<bool, int64_t, double, std::string, std::vector<std::string>>;

template <class T>
OptionValue ToOptionValue(const T& field) {
  if constexpr (kIsAuto<T>) {
    return field.is_auto() ? OptionValue(std::string("auto")) : ToOptionValue(field.value());
  } else if constexpr (std::is_enum_v<T>) {
    return Word(field);
  } else if constexpr (std::is_same_v<T, std::filesystem::path>) {
    return field.string();
  } else if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::string> ||
                       std::is_same_v<T, std::vector<std::string>>) {
    return field;
  } else if constexpr (std::is_integral_v<T>) {
    return static_cast<int64_t>(field);
  } else {
    return static_cast<double>(field);
  }
}

/// "true", "12", "0.5", "auto", "a, b": as the help and the messages show it.
std::string TextOf(const OptionValue& value);

/// Sets the field from the user's text, which a list of texts receives behind those that it has. Throws UsageError
/// "--init is 'x', must be one of: auto, dense".
template <class T>
void SetOption(const char* name, const std::string& text, T* field, Tier tier = Tier::kFlag) {
  [[maybe_unused]] const auto refuse = [&](const std::string& must) {
    throw UsageError("{} is '{}', {}", OptionShown(tier, name), text, must);
  };
  if constexpr (kIsAuto<T>) {
    if (text == "auto") {
      *field = {};
      return;
    }
    typename T::Value value{};
    if constexpr (std::is_enum_v<typename T::Value>) {
      const auto known = FromWord<typename T::Value>(text);
      if (!known) refuse("must be one of: auto, " + AllWords<typename T::Value>(", "));
      value = *known;
    } else {
      SetOption(name, text, &value, tier);
    }
    *field = value;
  } else if constexpr (std::is_enum_v<T>) {
    const std::optional<T> value = FromWord<T>(text);
    if (!value) refuse("must be one of: " + AllWords<T>(", "));
    *field = *value;
  } else if constexpr (std::is_same_v<T, bool>) {
    if (text != "true" && text != "false") refuse("must be true or false");
    *field = text == "true";
  } else if constexpr (std::is_arithmetic_v<T>) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc::result_out_of_range) refuse("which is too large");
    if (error != std::errc() || end != text.data() + text.size()) {
      refuse(std::is_integral_v<T> ? "must be a whole number" : "must be a number");
    }
    *field = value;
  } else if constexpr (std::is_same_v<T, std::vector<std::string>>) {
    field->push_back(text);
  } else {
    *field = text;
  }
}

/// Throws UsageError "--views is -3, must be in 0 .. 100000" for the first field out of its bounds.
struct OptionChecker {
  template <class T, class... Rest>
  void operator()(const char* name, const T& value, const char* help, const Rest&... rest) const {
    if constexpr (kIsAuto<T>) {
      if (!value.is_auto()) (*this)(name, value.value(), help, rest...);
    } else if constexpr (std::is_arithmetic_v<T>) {
      const std::optional<Range> range = RangeIn(rest...);
      if (range && !(static_cast<double>(value) >= range->low && static_cast<double>(value) <= range->high)) {
        throw UsageError("{} is {}, must be in {} .. {}", OptionShown(TierIn(rest...), name), value, range->low,
                         range->high);
      }
    }
  }
};

template <class Options>
void CheckOptions(const Options& options) {
  Options::Visit(options, OptionChecker{});
}

struct NamedOption {
  std::string name;
  OptionValue value;
  Tier tier = Tier::kFlag;
};

/// Every field with its value, in the order of Visit.
template <class Options>
std::vector<NamedOption> ListOptions(const Options& options) {
  std::vector<NamedOption> list;
  Options::Visit(options, [&](const char* name, const auto& value, const char*, const auto&... rest) {
    list.push_back({name, ToOptionValue(value), TierIn(rest...)});
  });
  return list;
}

/// {"views": 12, ...}: what a run saves, and what resuming compares.
nlohmann::json ToJson(const std::vector<NamedOption>& options);
template <class Options, class Json = nlohmann::json>  // a parameter: only callers need the whole type
Json OptionsToJson(const Options& options) {
  return ToJson(ListOptions(options));
}

/// Words of which the text of an option is a list, separated by commas. Stands behind the help of its declaration: help
/// and completion show them, and whoever checks the options compares.
struct WordList {
  std::vector<std::string> words;
};

/// Words among what a declaration has behind the help; empty without a WordList.
template <class... Rest>
std::vector<std::string> WordsIn(const Rest&... rest) {
  std::vector<std::string> words;
  [[maybe_unused]] const auto look = [&](const auto& one) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(one)>, WordList>) words = one.words;
  };
  (look(rest), ...);
  return words;
}

}  // namespace oraclegs
