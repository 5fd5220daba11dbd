#include "oraclegs/core/option_table.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "oraclegs/core/text.h"

namespace oraclegs {

void TableOption::Set(const std::string& text) {
  try {
    set_(text);
  } catch (const UsageError& error) {
    throw UsageError("{}{}", error.what(), DidYouMean(text, words_));
  }
  given_ = true;
}

void TableOption::Set(const nlohmann::json& value) {
  if (value.is_string()) return Set(value.get<std::string>());
  const std::string text = value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (!value.is_boolean() && !value.is_number()) {
    throw UsageError("{} is {}, must be a number, a text, or true or false", OptionShown(tier_, name_), text);
  }
  Set(text);
}

TableOption* OptionTable::Find(const std::string& name) {
  const auto found = std::find_if(options_.begin(), options_.end(), [&](const auto& o) { return o.name() == name; });
  return found == options_.end() ? nullptr : &*found;
}

std::vector<std::string> OptionTable::Names() const {
  std::vector<std::string> names;
  for (const TableOption& option : options_) names.push_back(option.name());
  return names;
}

bool OptionTable::IsGiven(const std::string& name) const {
  const auto found = std::find_if(options_.begin(), options_.end(), [&](const auto& o) { return o.name() == name; });
  return found != options_.end() && found->given();
}

}  // namespace oraclegs
