#include "oraclegs/core/share.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(Share, GivesEachPartToOneOfThem) {
  for (const size_t count : {1u, 2u, 3u, 7u}) {
    for (size_t part = 0; part < 20; ++part) {
      size_t owners = 0;
      for (size_t index = 0; index < count; ++index) owners += Share{index, count}.Has(part) ? 1 : 0;
      EXPECT_EQ(owners, 1u) << part << " of " << count;
    }
  }
}

TEST(Share, IsReadAsItIsWritten) {
  EXPECT_EQ(ToText({1, 3}), "2/3");
  EXPECT_EQ(ParseShare("2/3"), (Share{1, 3}));
  EXPECT_EQ(ParseShare(ToText({0, 1})), Share());
}

TEST(Share, IsNothingElse) {
  for (const char* text :
       {"", "/", "1", "1/", "/2", "0/2", "3/2", "1/0", "-1/2", "1/2x", "1/2/3", " 1/2", "1/99999999999999999999999"}) {
    EXPECT_FALSE(ParseShare(text)) << text;
  }
}

}  // namespace
}  // namespace oraclegs
