#include "oraclegs/core/options.h"

#include <nlohmann/json.hpp>

namespace oraclegs {

std::string OptionShown(Tier tier, const std::string& name) {
  return (tier == Tier::kSetting ? "--set " : "--") + name;
}

std::string TextOf(const OptionValue& value) {
  if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const int64_t* whole = std::get_if<int64_t>(&value)) return fmt::format("{}", *whole);
  if (const double* number = std::get_if<double>(&value)) return fmt::format("{:.6}", *number);
  if (const auto* list = std::get_if<std::vector<std::string>>(&value))
    return fmt::format("{}", fmt::join(*list, ", "));
  return std::get<std::string>(value);
}

nlohmann::json ToJson(const std::vector<NamedOption>& options) {
  nlohmann::json json = nlohmann::json::object();
  for (const NamedOption& option : options) {
    std::visit([&](const auto& value) { json[option.name] = value; }, option.value);
  }
  return json;
}

}  // namespace oraclegs
