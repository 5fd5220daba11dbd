#include "oraclegs/core/unique_json.h"

#include <set>
#include <vector>

#include "oraclegs/core/error.h"

namespace oraclegs {

using nlohmann::json;

namespace {
constexpr int kDeepestJson = 64;  // levels; the library copies and destroys values by recursion
}  // namespace

json ParseUniqueJson(std::string_view text, const std::string& file, const std::string& part) {
  std::vector<std::set<std::string>> keys;
  const auto check = [&](int depth, json::parse_event_t event, json& value) {
    const bool opens = event == json::parse_event_t::object_start || event == json::parse_event_t::array_start;
    if (opens && depth >= kDeepestJson) {
      throw InputError("{}: the {} is nested more than {} levels deep; write the file again", file, part, kDeepestJson);
    }
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    if (event == json::parse_event_t::object_end) keys.pop_back();
    if (event == json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second) {
      throw InputError("{}: the {} names {} twice; write the file again", file, part,
                       QuotedForMessage(value.get<std::string>()));
    }
    return true;
  };
  try {
    return json::parse(text.begin(), text.end(), check);
  } catch (const json::parse_error& error) {
    throw InputError("{}: the {} is not valid JSON (at byte {}); the file is damaged, get it again", file, part,
                     error.byte);
  } catch (const json::exception&) {
    throw InputError("{}: the {} is not valid JSON; the file is damaged, get it again", file, part);
  }
}

json ParseJson(std::string_view text) {
  const auto check = [](int depth, json::parse_event_t event, json&) {
    const bool opens = event == json::parse_event_t::object_start || event == json::parse_event_t::array_start;
    if (opens && depth >= kDeepestJson) {
      throw json::other_error::create(501, fmt::format("nested more than {} levels deep", kDeepestJson), nullptr);
    }
    return true;
  };
  return json::parse(text.begin(), text.end(), check);
}

json ParseJsonOrDiscard(std::string_view text) {
  try {
    return ParseJson(text);
  } catch (const json::exception&) {
    return json::value_t::discarded;
  }
}

std::string QuotedForMessage(const std::string& name) {
  return json(name.substr(0, 120)).dump(-1, ' ', true, json::error_handler_t::replace);
}

}  // namespace oraclegs
