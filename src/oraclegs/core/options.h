#pragma once
// An option is declared once, in the Visit of its struct; the command line, the TOML file, --help, the range check and
// the options saved with a run all read that list.
//
//   struct SplitOptions {
//     int views = 0;
//     template <class V> void Visit(V&& visit) {
//       visit("views", views, "Training views to pick, 0 = all", Range{0, 100000});
//     }
//   };

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "oraclegs/core/error.h"

namespace oraclegs {

/// Inclusive bounds of a number.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

/// The allowed words of a text option.
struct Choice {
  std::vector<std::string> words;
};

/// Throws UsageError "--views is -3, must be in 0 .. 100000" for the first field out of its bounds or words.
struct OptionChecker {
  template <class T>
  void operator()(const char* name, const T& value, const char*, const Range& range) const {
    if constexpr (std::is_arithmetic_v<T>) {
      if (!(static_cast<double>(value) >= range.low && static_cast<double>(value) <= range.high)) {
        throw UsageError("--{} is {}, must be in {} .. {}", name, value, range.low, range.high);
      }
    }
  }
  void operator()(const char* name, const std::string& value, const char*, const Choice& choice) const {
    for (const auto& word : choice.words) {
      if (word == value) return;
    }
    throw UsageError("--{} is '{}', must be one of: {}", name, value, fmt::join(choice.words, ", "));
  }
  template <class T>
  void operator()(const char*, const T&, const char*) const {}
};

template <class Options>
void CheckOptions(const Options& options) {
  const_cast<Options&>(options).Visit(OptionChecker{});  // Visit is non-const only because the parser writes through it
}

/// {"views": 12, ...}: what a run saves, and what resuming compares.
template <class Options>
nlohmann::json OptionsToJson(const Options& options) {
  nlohmann::json json = nlohmann::json::object();
  const_cast<Options&>(options).Visit([&](const char* name, const auto& value, auto&&...) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::filesystem::path>) {
      json[name] = value.string();
    } else {
      json[name] = value;
    }
  });
  return json;
}

}  // namespace oraclegs
