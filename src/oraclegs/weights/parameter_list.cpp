#include "oraclegs/weights/parameter_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <stdexcept>

namespace oraclegs {

// Made by cmake/EmbedText.cmake from lists/*.txt.
std::string_view EmbeddedParameterList(std::string_view name);

namespace {

constexpr std::string_view kIgnore = "ignore ";

std::optional<int64_t> Number(std::string_view text) {
  int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || error != std::errc() || end != text.data() + text.size() || number < 0) return std::nullopt;
  return number;
}

std::vector<std::string_view> Split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (size_t end; (end = text.find(separator)) != std::string_view::npos; text.remove_prefix(end + 1)) {
    parts.push_back(text.substr(0, end));
  }
  parts.push_back(text);
  return parts;
}

/// "0-2,weight" -> 0, 1, 2, weight
std::vector<std::string> Choices(std::string_view braces) {
  std::vector<std::string> words;
  for (const std::string_view item : Split(braces, ',')) {
    const size_t dash = item.find('-');
    const auto first = Number(item.substr(0, dash));
    const auto last = dash == std::string_view::npos ? std::nullopt : Number(item.substr(dash + 1));
    if (!first || !last) {
      words.emplace_back(item);
      continue;
    }
    for (int64_t i = *first; i <= *last; ++i) words.push_back(std::to_string(i));
  }
  return words;
}

std::vector<std::string> Expand(std::string_view pattern) {
  const size_t open = pattern.find('{'), close = pattern.find('}', open);
  if (open == std::string_view::npos) return {std::string(pattern)};
  if (close == std::string_view::npos) throw std::logic_error(fmt::format("no }} in {}", pattern));
  std::vector<std::string> names;
  const std::vector<std::string> rests = Expand(pattern.substr(close + 1));
  for (const std::string& word : Choices(pattern.substr(open + 1, close - open - 1))) {
    for (const std::string& rest : rests) names.push_back(std::string(pattern.substr(0, open)) + word + rest);
  }
  return names;
}

std::vector<int64_t> Shape(std::string_view text) {
  std::vector<int64_t> shape;
  for (const std::string_view size : Split(text, 'x')) {
    const auto number = Number(size);
    if (!number) throw std::logic_error(fmt::format("{} is no shape", text));
    shape.push_back(*number);
  }
  return shape;
}

}  // namespace

bool ParameterList::Ignores(std::string_view name) const {
  return std::any_of(ignored.begin(), ignored.end(), [&](const std::string& start) { return name.starts_with(start); });
}

ParameterList ParseParameterList(std::string_view text) {
  ParameterList list;
  for (std::string_view line : Split(text, '\n')) {
    if (line.empty() || line.front() == '#') continue;
    if (line.starts_with(kIgnore)) {
      list.ignored.emplace_back(line.substr(kIgnore.size()));
      continue;
    }
    const bool optional = line.front() == '?';
    if (optional) line.remove_prefix(1);
    const auto words = Split(line, ' ');
    if (words.size() != 2) throw std::logic_error(fmt::format("'{}' is no name and shape", line));
    for (const std::string& name : Expand(words[0])) {
      if (!list.tensors.emplace(name, ExpectedTensor{Shape(words[1]), optional}).second) {
        throw std::logic_error(fmt::format("{} comes twice", name));
      }
    }
  }
  return list;
}

ParameterList ParametersOf(const std::string& list) {
  const std::string_view text = EmbeddedParameterList(list);
  if (text.empty()) throw std::logic_error(fmt::format("there is no list of parameters called {}", list));
  return ParseParameterList(text);
}

}  // namespace oraclegs
