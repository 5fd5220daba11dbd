#pragma once

#include <string>
#include <type_traits>
#include <vector>

namespace oraclegs {

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
