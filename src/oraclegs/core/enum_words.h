#pragma once
// Enumerations that have words: on the command line, in TOML, help and saved runs.
//
//   enum class Background { kBlack, kWhite };
//   template <>
//   struct EnumWords<Background> {
//     static constexpr EnumWord<Background> kWords[] = {{Background::kBlack, "black"}, {Background::kWhite, "white"}};
//   };

#include <optional>
#include <string>
#include <string_view>

namespace oraclegs {

template <class E>
struct EnumWord {
  E value;
  const char* word;
};

/// Specialized for each enumeration that has words; kWords lists all its values in the order of the help.
template <class E>
struct EnumWords;

template <class E>
concept NamedEnum = requires {
  EnumWords<E>::kWords;
};

template <NamedEnum E>
std::string Word(E value) {
  for (const EnumWord<E>& entry : EnumWords<E>::kWords) {
    if (entry.value == value) return entry.word;
  }
  return "";
}

/// Nothing for an unknown word.
template <NamedEnum E>
std::optional<E> FromWord(std::string_view word) {
  for (const EnumWord<E>& entry : EnumWords<E>::kWords) {
    if (entry.word == word) return entry.value;
  }
  return std::nullopt;
}

/// "black, white" with the separator ", ".
template <NamedEnum E>
std::string AllWords(std::string_view separator) {
  std::string words;
  for (const EnumWord<E>& entry : EnumWords<E>::kWords) {
    if (!words.empty()) words += separator;
    words += entry.word;
  }
  return words;
}

}  // namespace oraclegs
