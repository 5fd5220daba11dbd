#include "oraclegs/core/unique_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

using testing::StrEq;
using testing::ThrowsMessage;

TEST(UniqueJson, Parses) { EXPECT_EQ(ParseUniqueJson(R"({"a":{"b":1},"b":[2]})", "f", "header")["a"]["b"], 1); }

TEST(UniqueJson, RefusesWhatIsSaidTwice) {
  EXPECT_THAT([] { ParseUniqueJson(R"({"a":1,"a":2})", "f", "header"); },
              ThrowsMessage<InputError>(StrEq("f: the header names \"a\" twice; write the file again")));
  EXPECT_THAT([] { ParseUniqueJson(R"({"x":{"b":1,"b":1}})", "f", "index"); },
              ThrowsMessage<InputError>(StrEq("f: the index names \"b\" twice; write the file again")));
}

TEST(UniqueJson, RefusesWhatIsNoJson) {
  EXPECT_THAT([] { ParseUniqueJson("{", "f", "header"); },
              ThrowsMessage<InputError>(
                  StrEq("f: the header is not valid JSON (at byte 2); the file is damaged, get it again")));
}

TEST(UniqueJson, RefusesWhatIsNestedTooDeep) {
  const auto arrays = [](size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); };
  EXPECT_NO_THROW(ParseUniqueJson(arrays(64), "f", "header"));
  for (const size_t levels : {size_t{65}, size_t{3000000}}) {
    EXPECT_THAT(
        [&] { ParseUniqueJson(arrays(levels), "f", "header"); },
        ThrowsMessage<InputError>(StrEq("f: the header is nested more than 64 levels deep; write the file again")));
  }
  std::string objects = "1";
  for (int i = 0; i < 65; ++i) objects = R"({"a":)" + objects + "}";
  EXPECT_THROW(ParseUniqueJson(objects, "f", "header"), InputError);
}

TEST(UniqueJson, NamesFitIntoALine) {
  EXPECT_EQ(QuotedForMessage("a"), "\"a\"");
  EXPECT_EQ(QuotedForMessage("a\nb\"\xff"), "\"a\\nb\\\"\\ufffd\"");
  EXPECT_EQ(QuotedForMessage(std::string(500, 'a')).size(), 122u);
}

TEST(ParseJson, ReadsAnyJson) {
  EXPECT_EQ(ParseJson(R"({"a": [1, 2], "a": 3})")["a"], 3);
  EXPECT_THROW(ParseJson("{"), nlohmann::json::parse_error);
  EXPECT_EQ(ParseJsonOrDiscard("[1]")[0], 1);
  EXPECT_TRUE(ParseJsonOrDiscard("[1").is_discarded());
}

TEST(ParseJson, RefusesWhatIsNestedTooDeep) {
  const auto arrays = [](size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); };
  EXPECT_NO_THROW(ParseJson(arrays(64)));
  for (const size_t levels : {size_t{65}, size_t{3000000}}) {
    EXPECT_THROW(ParseJson(arrays(levels)), nlohmann::json::exception);
    EXPECT_TRUE(ParseJsonOrDiscard(arrays(levels)).is_discarded());
  }
}

TEST(ParseJson, TakesTimeInProportion) {
  std::string list = "[";  // hours where each object is compared with all before it
  for (int i = 0; i < 1000000; ++i) list += "{},";
  list += "{}]";
  EXPECT_EQ(ParseJson(list).size(), 1000001u);
  EXPECT_EQ(ParseUniqueJson(list, "f", "header").size(), 1000001u);
}

}  // namespace
}  // namespace oraclegs
