#include "oraclegs/scene/fold_name.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(FoldName, IgnoresCaseAndUnicodeForm) {
  EXPECT_EQ(FoldName("IMG_01.JPG"), "img_01.jpg");
  EXPECT_EQ(FoldName("K\u00FCche"), FoldName("Ku\u0308che"));     // one letter; letter and accent
  EXPECT_EQ(FoldName("\u00DCBER"), FoldName("\u00FCber"));        // capital and small
  EXPECT_EQ(FoldName("\u30AC"), FoldName("\u30AB\u3099"));        // katakana GA
  EXPECT_EQ(FoldName("\uD55C"), FoldName("\u1112\u1161\u11AB"));  // Hangul syllable and its letters
  EXPECT_EQ(FoldName("\u0419"), FoldName("\u0438\u0306"));        // Cyrillic short I
  EXPECT_NE(FoldName("a1"), FoldName("a2"));
}

TEST(FoldName, KeepsWhatIsNotUtf8) {
  EXPECT_EQ(FoldName("A\xFF\xC3"), "a\xFF\xC3");
  EXPECT_EQ(FoldName("\xF0\x9F\x93\xB7"), "\xF0\x9F\x93\xB7");
  EXPECT_EQ(FoldName(""), "");
}

}  // namespace
}  // namespace oraclegs
