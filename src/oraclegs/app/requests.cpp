#include "oraclegs/app/requests.h"

#include "oraclegs/core/text.h"
#include "oraclegs/core/unique_json.h"

namespace oraclegs {
namespace {

constexpr uint64_t kMaxJsonBytes = 64 << 10;

}  // namespace

WebAnswer JsonDocument(const nlohmann::json& json, int status) {
  WebAnswer answer;
  answer.status = status;
  answer.type = "application/json";
  answer.body = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return answer;
}

WebAnswer ErrorAnswer(const Refusal& refusal) {
  nlohmann::json json = {{"error", OneLine(refusal.reason)}};
  if (refusal.is_permanent) json["permanent"] = true;
  return JsonDocument(json, refusal.status);
}

nlohmann::json ObjectOf(const WebRequest& request) {
  const uint64_t bytes = request.content_length.value_or(0);
  if (bytes == 0) return nlohmann::json::object();
  if (bytes > kMaxJsonBytes) throw Refusal{413, "the request is too large"};
  std::string text(bytes, '\0');
  for (size_t at = 0; at < text.size();) {
    const ptrdiff_t n = request.read ? request.read(text.data() + at, text.size() - at) : 0;
    if (n <= 0) throw Refusal{400, "the request was not sent to its end"};
    at += static_cast<size_t>(n);
  }
  nlohmann::json json = ParseJsonOrDiscard(text);
  if (!json.is_object()) throw Refusal{400, "the request is no JSON object"};
  return json;
}

std::string TextAsked(const nlohmann::json& body, const char* key, const std::string& otherwise) {
  const nlohmann::json value = body.value(key, nlohmann::json(otherwise));
  if (!value.is_string()) throw Refusal{400, fmt::format("{}: must be a text", key)};
  return value.get<std::string>();
}

}  // namespace oraclegs
