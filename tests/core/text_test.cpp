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

}  // namespace
}  // namespace oraclegs
