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
// number or an enumeration: "auto" decides for the user.

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

/// Sets the field from the user's text. Throws UsageError "--init is 'x', must be one of: auto, dense".
template <class T>
void SetOption(const char* name, const std::string& text, T* field) {
  if constexpr (kIsAuto<T>) {
    if (text == "auto") {
      *field = {};
      return;
    }
    typename T::Value value{};
    if constexpr (std::is_enum_v<typename T::Value>) {
      const auto known = FromWord<typename T::Value>(text);
      if (!known)
        throw UsageError("--{} is '{}', must be one of: auto, {}", name, text, AllWords<typename T::Value>(", "));
      value = *known;
    } else {
      SetOption(name, text, &value);
    }
    *field = value;
  } else if constexpr (std::is_enum_v<T>) {
    const std::optional<T> value = FromWord<T>(text);
    if (!value) throw UsageError("--{} is '{}', must be one of: {}", name, text, AllWords<T>(", "));
    *field = *value;
  } else if constexpr (std::is_same_v<T, bool>) {
    if (text != "true" && text != "false") throw UsageError("--{} is '{}', must be true or false", name, text);
    *field = text == "true";
  } else if constexpr (std::is_arithmetic_v<T>) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc::result_out_of_range) throw UsageError("--{} is '{}', which is too large", name, text);
    if (error != std::errc() || end != text.data() + text.size()) {
      throw UsageError("--{} is '{}', must be a {}number", name, text, std::is_integral_v<T> ? "whole " : "");
    }
    *field = value;
  } else {
    *field = text;
  }
}

/// Throws UsageError "--views is -3, must be in 0 .. 100000" for the first field out of its bounds.
struct OptionChecker {
  template <class T>
  void operator()(const char* name, const T& value, const char* help, const Range& range) const {
    if constexpr (kIsAuto<T>) {
      if (!value.is_auto()) (*this)(name, value.value(), help, range);
    } else if constexpr (std::is_arithmetic_v<T>) {
      if (!(static_cast<double>(value) >= range.low && static_cast<double>(value) <= range.high)) {
        throw UsageError("--{} is {}, must be in {} .. {}", name, value, range.low, range.high);
      }
    }
  }
  template <class T>
  void operator()(const char*, const T&, const char*) const {}
};

template <class Options>
void CheckOptions(const Options& options) {
  Options::Visit(options, OptionChecker{});
}

struct NamedOption {
  std::string name;
  OptionValue value;
};

/// Every field with its value, in the order of Visit.
template <class Options>
std::vector<NamedOption> ListOptions(const Options& options) {
  std::vector<NamedOption> list;
  Options::Visit(options, [&](const char* name, const auto& value, auto&&...) {
    list.push_back({name, ToOptionValue(value)});
  });
  return list;
}

/// {"views": 12, ...}: what a run saves, and what resuming compares.
nlohmann::json ToJson(const std::vector<NamedOption>& options);
template <class Options, class Json = nlohmann::json>  // a parameter: only callers need the whole type
Json OptionsToJson(const Options& options) {
  return ToJson(ListOptions(options));
}

}  // namespace oraclegs
