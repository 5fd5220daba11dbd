#include "oraclegs/capture/free_names.h"

#include <fmt/format.h>

#include <algorithm>

namespace oraclegs {
namespace {

std::string WithoutCase(const std::filesystem::path& name) {
  std::string folded = name.generic_string();
  std::transform(folded.begin(), folded.end(), folded.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return folded;
}

}  // namespace

void FreeNames::Block(const std::filesystem::path& name) { taken_.insert(WithoutCase(name)); }

std::filesystem::path FreeNames::Take(const std::filesystem::path& wanted) {
  std::filesystem::path name = wanted;
  int& next = next_.try_emplace(WithoutCase(wanted), 2).first->second;
  while (!taken_.insert(WithoutCase(name)).second) {
    name = wanted.parent_path() / fmt::format("{}-{}{}", wanted.stem().string(), next++, wanted.extension().string());
  }
  return name;
}

}  // namespace oraclegs
