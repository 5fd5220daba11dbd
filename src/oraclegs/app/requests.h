#pragma once
// Requests of a browser that change something, and the answers to them, as JSON.

#include <nlohmann/json.hpp>
#include <string>

#include "oraclegs/web/answers.h"

namespace oraclegs {

/// A change that is refused, with its status and a reason in words.
struct Refusal {
  int status;
  std::string reason;
  bool is_permanent = false;  ///< asks whether a project may be removed for good
};

/// A JSON document.
WebAnswer JsonDocument(const nlohmann::json& json, int status = 200);

/// {"error": reason}, and {"permanent": true} with it where that is asked.
WebAnswer ErrorAnswer(const Refusal& refusal);

/// The JSON object in a request's body, of at most 64 KiB; an empty one without a body. Throws Refusal.
nlohmann::json ObjectOf(const WebRequest& request);

/// The text of a key, `otherwise` where there is none. Throws Refusal where it is something else.
std::string TextAsked(const nlohmann::json& body, const char* key, const std::string& otherwise = "");

}  // namespace oraclegs
