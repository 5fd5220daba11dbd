#include "oraclegs/core/text.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(FormatSeconds, ShowsHoursOnlyWhereThereAreAny) {
  EXPECT_EQ(FormatSeconds(0.4), "0:00");
  EXPECT_EQ(FormatSeconds(545), "9:05");
  EXPECT_EQ(FormatSeconds(3753), "1:02:33");
  EXPECT_EQ(FormatSeconds(-3), "0:00");
}

TEST(AlignColumns, SetsTextsLeftAndNumbersRight) {
  EXPECT_EQ(AlignColumns({{"stage", "time", "what"}, {"sfm", "0:09", ""}, {"evaluate", "10:00", "x"}}, "lrl"),
            "stage      time  what\n"
            "sfm        0:09\n"
            "evaluate  10:00  x\n");
}

TEST(AlignColumns, CountsCharactersAndNotBytes) {
  EXPECT_EQ(AlignColumns({{"1 ± 2", "a"}, {"12345", "b"}}, "ll"), "1 ± 2  a\n12345  b\n");
}

TEST(AlignColumns, AShortRowsLastTextWidensNothing) {
  EXPECT_EQ(AlignColumns({{"a", "1", "2"}, {"b", "failed: no points at all"}}, "lrr"),
            "a  1  2\nb  failed: no points at all\n");
}

TEST(SomeNames, ShowsFive) {
  EXPECT_EQ(SomeNames({}), "");
  EXPECT_EQ(SomeNames({"a", "b"}), "a, b");
  EXPECT_EQ(SomeNames({"a", "b", "c", "d", "e"}), "a, b, c, d, e");
  EXPECT_EQ(SomeNames({"a", "b", "c", "d", "e", "f", "g"}), "a, b, c, d, e and 2 more");
}

TEST(IsUtf8, RefusesIncompleteCharacters) {
  EXPECT_TRUE(IsUtf8(""));
  EXPECT_TRUE(IsUtf8("caf\xC3\xA9"));
  EXPECT_FALSE(IsUtf8("caf\xE9"));
  EXPECT_FALSE(IsUtf8("\xC3"));  // cut short
}

TEST(EscapeBytes, ShowsBytesOutsideAscii) { EXPECT_EQ(EscapeBytes("caf\xE9.jpg"), "caf\\xE9.jpg"); }

TEST(Printable, IsShortAndAscii) {
  EXPECT_EQ(Printable("a b~"), "a b~");
  EXPECT_EQ(Printable("a\n\x7f\xC3\xA9" + std::string(1, '\0')), "a?????");
  EXPECT_EQ(Printable("12345", 3), "123");
  EXPECT_EQ(Printable(std::string(500, 'x')).size(), 120u);
}

TEST(SplitAtCommas, DropsBlanksAndEmptyWords) {
  EXPECT_EQ(SplitAtCommas("a, b c ,,d"), (std::vector<std::string>{"a", "b c", "d"}));
  EXPECT_TRUE(SplitAtCommas(" , ").empty());
  EXPECT_TRUE(SplitAtCommas("").empty());
}

}  // namespace
}  // namespace oraclegs
