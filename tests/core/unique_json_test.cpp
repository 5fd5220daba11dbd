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

TEST(UniqueJson, NamesFitIntoALine) {
  EXPECT_EQ(QuotedForMessage("a"), "\"a\"");
  EXPECT_EQ(QuotedForMessage("a\nb\"\xff"), "\"a\\nb\\\"\\ufffd\"");
  EXPECT_EQ(QuotedForMessage(std::string(500, 'a')).size(), 122u);
}

}  // namespace
}  // namespace oraclegs
