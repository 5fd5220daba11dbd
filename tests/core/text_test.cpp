#include "oraclegs/core/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace oraclegs {
namespace {

TEST(NaturalLess, OrdersNumbersByTheirValue) {
  std::vector<std::string> names = {
      "r_10", "r_2", "r_02", "a/9.jpg", "a/10.jpg", "r_2b", "r", "R_3", "r_00000000000000000000010"};
  std::sort(names.begin(), names.end(), NaturalLess);
  EXPECT_EQ(names, (std::vector<std::string>{"R_3", "a/9.jpg", "a/10.jpg", "r", "r_02", "r_2", "r_2b",
                                             "r_00000000000000000000010", "r_10"}));
}

TEST(NaturalLess, IsAStrictWeakOrder) {
  const std::vector<std::string> names = {"",  "0",  "00",  "1",  "01",   "1a", "01a",
                                          "a", "a0", "a00", "a1", "\xff", "10", "9"};
  for (const auto& a : names) {
    EXPECT_FALSE(NaturalLess(a, a));
    for (const auto& b : names) {
      EXPECT_NE(a == b, NaturalLess(a, b) || NaturalLess(b, a)) << a << " " << b;
      EXPECT_FALSE(NaturalLess(a, b) && NaturalLess(b, a));
      for (const auto& c : names) {
        if (NaturalLess(a, b) && NaturalLess(b, c)) {
          EXPECT_TRUE(NaturalLess(a, c)) << a << " " << b << " " << c;
        }
      }
    }
  }
}

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

TEST(OneLine, ReplacesControlCharacters) {
  EXPECT_EQ(OneLine("a\nb\tc\x7F \xC3\xA4"), "a?b?c? \xC3\xA4");
  EXPECT_EQ(OneLine(std::string("a\0b\x1B[31m", 8)), "a?b?[31m");
}

TEST(OneLine, ReplacesControlCharactersOfUnicode) {
  EXPECT_EQ(OneLine("a\xC2\x9B"
                    "31m"),
            "a?31m");
  EXPECT_EQ(OneLine("\xC2\x80\xC2\x9F\xC2\xA0"), "??\xC2\xA0");
  EXPECT_EQ(OneLine("\xE2\x80\xA8\xE2\x80\xA9\xE2\x80\xAA\xE2\x80\xAE\xE2\x81\xA6\xE2\x81\xA9"), "??????");
  EXPECT_EQ(OneLine("\xE2\x80\xA7\xE2\x80\xAF\xE2\x81\xA5\xE2\x81\xAA"),
            "\xE2\x80\xA7\xE2\x80\xAF\xE2\x81\xA5\xE2\x81\xAA");
}

TEST(OneLine, ReplacesControlBytesThatArePartOfNoCharacter) {
  EXPECT_EQ(OneLine("a\x9B"
                    "31m \x85"),
            "a?31m ?")
      << "a terminal of 8 bits";
  EXPECT_EQ(OneLine("\xC0\x9B"), "\xC0?") << "written longer than needed";
  EXPECT_EQ(OneLine("\xE0\x80\x9B"), "\xE0??");
  EXPECT_EQ(OneLine("\xE2\x9B"), "\xE2?") << "cut";
  EXPECT_EQ(OneLine("caf\xE9.jpg"), "caf\xE9.jpg") << "a name in Latin-1";
}

TEST(OneLine, LeavesCharactersWhoseBytesLookLikeControls) {
  for (const std::string text :
       {"\xE2\x9B\x84", "\xF0\x9F\x98\x80", "\xC4\x9B\xC5\x9B", "\xE4\xB8\x80", "\xF4\x8F\xBF\xBF"}) {
    EXPECT_EQ(OneLine(text), text);
  }
}

TEST(ForTerminal, KeepsLinesAndTabs) { EXPECT_EQ(ForTerminal("a\n\tb\r\x1B[m\xC2\x9B\n"), "a\n\tb??[m?\n"); }

TEST(PercentEncoded, LeavesPlainPathsAlone) {
  EXPECT_EQ(PercentEncoded("/home/a-b_c.d/e"), "/home/a-b_c.d/e");
  EXPECT_EQ(PercentEncoded("Zo\xc3\xab 1%\n\";"), "Zo%C3%AB%201%25%0A%22%3B");
}

TEST(EscapeBytes, ShowsBytesOutsideAscii) { EXPECT_EQ(EscapeBytes("caf\xE9.jpg"), "caf\\xE9.jpg"); }

TEST(Printable, IsShortAndAscii) {
  EXPECT_EQ(Printable("a b~"), "a b~");
  EXPECT_EQ(Printable("a\n\x7f\xC3\xA9" + std::string(1, '\0')), "a?????");
  EXPECT_EQ(Printable("12345", 3), "123");
  EXPECT_EQ(Printable(std::string(500, 'x')).size(), 120u);
}

TEST(SplitTrimmed, DropsBlanksAndEmptyParts) {
  EXPECT_EQ(SplitTrimmed("a, b c ,,d", ','), (std::vector<std::string>{"a", "b c", "d"}));
  EXPECT_EQ(SplitTrimmed("a, b\r\n\nc", '\n'), (std::vector<std::string>{"a, b", "c"}));
  EXPECT_TRUE(SplitTrimmed(" , ", ',').empty());
  EXPECT_TRUE(SplitTrimmed("", ',').empty());
}

TEST(ShellQuoted, LeavesPlainWordsAndQuotesOthers) {
  EXPECT_EQ(ShellQuoted("out/fox-1.ply"), "out/fox-1.ply");
  EXPECT_EQ(ShellQuoted("caf\xc3\xa9"), "caf\xc3\xa9");
  EXPECT_EQ(ShellQuoted("my scene"), "'my scene'");
  EXPECT_EQ(ShellQuoted("it's"), "'it'\\''s'");
  EXPECT_EQ(ShellQuoted(""), "''");
}

TEST(Counted, HasAnSUnlessThereIsOne) {
  EXPECT_EQ(Counted(0, "test view"), "0 test views");
  EXPECT_EQ(Counted(1, "test view"), "1 test view");
  EXPECT_EQ(Counted(size_t{12}, "photo"), "12 photos");
}

const std::vector<std::string> kOptions = {"iterations", "views", "view", "out", "quality", "max-gaussians"};

TEST(NearestWord, FindsSlips) {
  EXPECT_EQ(NearestWord("iteration", kOptions), "iterations");
  EXPECT_EQ(NearestWord("iterationz", kOptions), "iterations");
  EXPECT_EQ(NearestWord("itreations", kOptions), "iterations");
  EXPECT_EQ(NearestWord("veiws", kOptions), "views");
  EXPECT_EQ(NearestWord("max-gausians", kOptions), "max-gaussians");
  EXPECT_EQ(NearestWord("QUALITY", kOptions), "quality");
}

TEST(NearestWord, FindsBeginnings) {
  EXPECT_EQ(NearestWord("iter", kOptions), "iterations");
  EXPECT_EQ(NearestWord("max", kOptions), "max-gaussians");
}

TEST(NearestWord, FindsNothingFarAway) {
  EXPECT_EQ(NearestWord("frobnicate", kOptions), "");
  EXPECT_EQ(NearestWord("", kOptions), "");
  EXPECT_EQ(NearestWord("it", kOptions), "");
  EXPECT_EQ(NearestWord("x", {"y"}), "");
  EXPECT_EQ(NearestWord(std::string(100000, 'x'), kOptions), "");
  EXPECT_EQ(NearestWord("views", {}), "");
}

TEST(NearestWord, TakesTheNearest) {
  EXPECT_EQ(NearestWord("view", kOptions), "view");
  EXPECT_EQ(NearestWord("viewz", kOptions), "views") << "the first of those as near";
}

TEST(DidYouMean, EndsAMessage) {
  EXPECT_EQ(DidYouMean("whit", {"black", "white"}), "; did you mean 'white'?");
  EXPECT_EQ(DidYouMean("pink", {"black", "white"}), "");
}

}  // namespace

}  // namespace oraclegs
