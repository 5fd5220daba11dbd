#include "oraclegs/app/requests.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace oraclegs {
namespace {

using nlohmann::json;

/// A request with a body, of which `missing` bytes do not arrive.
WebRequest RequestWith(const std::string& body, size_t missing = 0) {
  WebRequest request{"POST", "/api/projects", "127.0.0.1:7860"};
  request.content_length = body.size();
  request.read = [sent = body.substr(0, body.size() - missing), at = size_t{0}](char* to, size_t count) mutable {
    const size_t n = std::min({count, sent.size() - at, size_t{3}});
    std::memcpy(to, sent.data() + at, n);
    at += n;
    return static_cast<ptrdiff_t>(n);
  };
  return request;
}

int StatusOf(const WebRequest& request) {
  try {
    ObjectOf(request);
    return 200;
  } catch (const Refusal& refusal) {
    EXPECT_FALSE(refusal.reason.empty());
    return refusal.status;
  }
}

TEST(ObjectOf, ReadsAnObjectAndNothingElse) {
  EXPECT_EQ(ObjectOf(RequestWith(R"({"name": "garden"})")), json({{"name", "garden"}}));
  EXPECT_EQ(ObjectOf(WebRequest{"POST", "/", "127.0.0.1"}), json::object());
  for (const char* body : {"[1]", "3", "{", "name=garden", "{\"a\": \xff}"})
    EXPECT_EQ(StatusOf(RequestWith(body)), 400) << body;
  EXPECT_EQ(StatusOf(RequestWith(R"({"name": "garden"})", 5)), 400) << "cut off";
  EXPECT_EQ(StatusOf(RequestWith(std::string(100'000, ' '))), 413);
}

TEST(TextAsked, RefusesOtherKinds) {
  const json body = {{"name", "garden"}, {"size", 3}};
  EXPECT_EQ(TextAsked(body, "name"), "garden");
  EXPECT_EQ(TextAsked(body, "quality", "normal"), "normal");
  EXPECT_THROW(TextAsked(body, "size"), Refusal);
}

TEST(ErrorAnswer, IsOneLineOfJson) {
  const WebAnswer answer = ErrorAnswer({409, "a\nb", true});
  EXPECT_EQ(answer.status, 409);
  EXPECT_EQ(json::parse(answer.body), json({{"error", "a?b"}, {"permanent", true}}));
  EXPECT_FALSE(json::parse(ErrorAnswer({400, "x"}).body).contains("permanent"));
}

}  // namespace
}  // namespace oraclegs
