#include "oraclegs/experiments/bench/methods.h"

#include <algorithm>

#include "oraclegs/core/nearest_word.h"
#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

/// Rates and terms of 3DGS and of the programs built on it, where this program's own differ.
RunArguments Plain3dgs() {
  return {{"proposers", "none"},          {"depth-prior", "none"}, {"depth-weight", "0"},   {"alpha-weight", "0"},
          {"opacity-noise", "0"},         {"dropout", "0"},        {"largest-scale", "0"},  {"exposure", "off"},
          {"prune-floaters", "false"},    {"coarse-share", "0"},   {"last-rates", "1"},     {"rate-scale", "1"},
          {"sh-degree-interval", "1000"}, {"refine-start", "500"}, {"refine-every", "100"}, {"init", "sfm"},
          {"init-scale", "0.1"}};
}

}  // namespace

const std::vector<Method>& Methods() {
  static const std::vector<Method> methods = {
      {"ours", "OracleGS (this program)", "", {}, {}, ""},
      {"ours-no-proposals", "OracleGS without proposals", "", {{"proposers", "none"}}, {}, ""},
      {"3dgs-mcmc", "3DGS-MCMC", "Kheradmand 2024", Plain3dgs(), {{"iterations", "10000"}}, ""},
  };
  return methods;
}

std::vector<Method> FindMethods(const std::string& list) {
  std::vector<Method> found;
  std::vector<std::string> names;
  for (const Method& method : Methods()) names.push_back(method.name);
  for (const std::string& word : SplitTrimmed(list, ',')) {
    const auto at = std::find(names.begin(), names.end(), word);
    if (at == names.end()) {
      throw UsageError("--methods names '{}'; there are {}{}", word, fmt::join(names, ", "), DidYouMean(word, names));
    }
    const Method& method = Methods()[static_cast<size_t>(at - names.begin())];
    const bool again = std::any_of(found.begin(), found.end(), [&](const Method& m) { return m.name == method.name; });
    if (!again) found.push_back(method);
  }
  if (found.empty()) throw UsageError("--methods names none; there are {}", fmt::join(names, ", "));
  return found;
}

}  // namespace oraclegs
