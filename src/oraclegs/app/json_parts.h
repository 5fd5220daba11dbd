#pragma once
// Values out of JSON that another process or a browser wrote: what is missing or of another kind counts as nothing.

#include <nlohmann/json.hpp>
#include <string>

namespace oraclegs {

/// The text of a key; empty where there is none.
inline std::string TextIn(const nlohmann::json& json, const char* key) {
  const nlohmann::json value = json.is_object() ? json.value(key, nlohmann::json()) : nlohmann::json();
  return value.is_string() ? value.get<std::string>() : "";
}

/// The number of a key; 0 where there is none.
inline double NumberIn(const nlohmann::json& json, const char* key) {
  const nlohmann::json value = json.is_object() ? json.value(key, nlohmann::json()) : nlohmann::json();
  return value.is_number() ? value.get<double>() : 0;
}

/// The list of a key; an empty one where there is none.
inline nlohmann::json ListIn(const nlohmann::json& json, const char* key) {
  nlohmann::json value = json.is_object() ? json.value(key, nlohmann::json()) : nlohmann::json();
  return value.is_array() ? value : nlohmann::json::array();
}

}  // namespace oraclegs
