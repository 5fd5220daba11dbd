#include "oraclegs/experiments/bench/run_arguments.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "oraclegs/settings/named_options.h"

namespace oraclegs {
namespace {

using nlohmann::json;

/// Names of options that are flags.
const std::set<std::string>& Flags() {
  static const std::set<std::string> flags = [] {
    std::set<std::string> names;
    const json defaults = RunOptionsToJson(RunOptions{});
    for (const auto& [name, value] : defaults.items()) {
      if (value.is_boolean()) names.insert(name);
    }
    return names;
  }();
  return flags;
}

template <class... Groups>
std::set<std::string> NamesOf(const Groups&... groups) {
  std::set<std::string> names;
  const auto add = [&](const auto& group) {
    for (const NamedOption& option : ListOptions(group)) names.insert(option.name);
  };
  (add(groups), ...);
  return names;
}

}  // namespace

const std::string* FindArgument(const RunArguments& arguments, const std::string& name) {
  const auto found = std::find_if(arguments.begin(), arguments.end(), [&](const auto& a) { return a.first == name; });
  return found == arguments.end() ? nullptr : &found->second;
}

RunArguments Overlaid(RunArguments below, const RunArguments& above) {
  for (const auto& argument : above) {
    const auto found =
        std::find_if(below.begin(), below.end(), [&](const auto& a) { return a.first == argument.first; });
    if (found == below.end()) {
      below.push_back(argument);
    } else {
      found->second = argument.second;
    }
  }
  return below;
}

std::vector<std::string> ArgumentWords(const RunArguments& arguments) {
  std::vector<std::string> words;
  for (const auto& [name, value] : arguments) {
    const bool is_flag = Flags().count(name) > 0;
    const json typed = is_flag ? json(value != "false") : json(value);
    for (std::string& word : RunOptionWords(name, typed)) words.push_back(std::move(word));
  }
  return words;
}

RunOptions OptionsOf(const RunArguments& arguments) {
  json values = json::object();
  for (const auto& [name, value] : arguments) {
    values[name] = value.empty() && Flags().count(name) > 0 ? "true" : value;
  }
  RunOptions options;
  SetRunOptions(values, UnknownOption::kError, &options);
  CheckRunOptions(options);
  return options;
}

json ResultArguments(const RunArguments& arguments) {
  static const std::set<std::string> free =
      NamesOf(DeviceOptions{}, MachineOptions{}, FileLimits{}, CheckpointSchedule{}, ReportOptions{}, FrameOptions{});
  json values = json::object();
  for (const auto& [name, value] : arguments) {
    if (free.count(name) == 0) values[name] = value.empty() && Flags().count(name) > 0 ? "true" : value;
  }
  return values;
}

std::string DifferenceOf(const json& before, const json& now) {
  std::set<std::string> names;
  for (const json* side : {&before, &now}) {
    for (const auto& [name, value] : side->items()) names.insert(name);
  }
  const auto shown = [](const json& side, const std::string& name) {
    if (!side.contains(name)) return std::string("not given");
    return side.at(name).is_string() ? side.at(name).get<std::string>() : side.at(name).dump();
  };
  std::string text;
  for (const std::string& name : names) {
    if (before.contains(name) == now.contains(name) && before.at(name) == now.at(name)) continue;
    text += fmt::format("{}{} was {}, now is {}", text.empty() ? "" : "; ", RunOptionShown(name), shown(before, name),
                        shown(now, name));
  }
  return text;
}

}  // namespace oraclegs
