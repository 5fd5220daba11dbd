#include "oraclegs/settings/named_options.h"

#include <map>
#include <nlohmann/json.hpp>

#include "oraclegs/core/text.h"

namespace oraclegs {
namespace {

/// Tier of each option of a run.
const std::map<std::string, Tier>& RunTiers() {
  static const std::map<std::string, Tier> tiers = [] {
    std::map<std::string, Tier> known;
    RunOptions options;
    OptionTable table = TableOf(&options);
    for (const std::string& name : table.Names()) known[name] = table.Find(name)->tier();
    return known;
  }();
  return tiers;
}

Tier TierOf(const std::string& name) {
  const auto found = RunTiers().find(name);
  return found == RunTiers().end() ? Tier::kFlag : found->second;
}

}  // namespace

OptionTable TableOf(RunOptions* options) {
  OptionTable table;
  RunOptions::ForEachGroup(*options, [&](const char*, auto& group) { table.AddAll(&group); });
  table.AddAll(&options->capture);
  return table;
}

std::vector<std::string> RunOptionNames() {
  RunOptions options;
  return TableOf(&options).Names();
}

void SetRunOptions(const nlohmann::json& values, UnknownOption unknown, RunOptions* options) {
  OptionTable table = TableOf(options);
  for (const auto& [name, value] : values.items()) {
    if (TableOption* option = table.Find(name)) {
      option->Set(value);
    } else if (unknown == UnknownOption::kError) {
      throw UsageError("there is no option --{}{}", name, DidYouMean(name, table.Names()));
    }
  }
}

std::string RunOptionShown(const std::string& name) { return OptionShown(TierOf(name), name); }

std::vector<std::string> RunOptionWords(const std::string& name, const nlohmann::json& value) {
  const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  if (TierOf(name) == Tier::kSetting) return {"--set", name + "=" + text};
  if (value.is_boolean()) return {(value.get<bool>() ? "--" : "--no-") + name};
  return {"--" + name, text};
}

}  // namespace oraclegs
