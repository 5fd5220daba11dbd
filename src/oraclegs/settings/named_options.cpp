#include "oraclegs/settings/named_options.h"

#include <nlohmann/json.hpp>
#include <set>

namespace oraclegs {
namespace {

/// Text of a value, as on the command line. Throws UsageError.
std::string TextOfJson(const std::string& name, const nlohmann::json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean() || value.is_number()) return value.dump();
  throw UsageError("--{} is {}, must be a number, a text, or true or false", name, value.dump());
}

/// Calls f for all groups that `reconstruct` has.
template <class Options, class F>
void ForEachNamedGroup(Options& options, F&& f) {
  RunOptions::ForEachGroup(options, [&](const char*, auto& group) { f(group); });
  f(options.capture);
}

}  // namespace

std::vector<std::string> RunOptionNames() {
  std::vector<std::string> names;
  const RunOptions options;
  ForEachNamedGroup(options, [&](const auto& group) {
    for (const NamedOption& option : ListOptions(group)) names.push_back(option.name);
  });
  return names;
}

void SetRunOptions(const nlohmann::json& values, UnknownOption unknown, RunOptions* options) {
  std::set<std::string> known;
  ForEachNamedGroup(*options, [&](auto& group) {
    std::remove_reference_t<decltype(group)>::Visit(group, [&](const char* name, auto& field, auto&&...) {
      if (!values.contains(name)) return;
      known.insert(name);
      SetOption(name, TextOfJson(name, values.at(name)), &field);
    });
  });
  if (unknown == UnknownOption::kIgnored) return;
  for (const auto& [name, value] : values.items()) {
    if (known.count(name) == 0) throw UsageError("there is no option --{}", name);
  }
}

}  // namespace oraclegs
