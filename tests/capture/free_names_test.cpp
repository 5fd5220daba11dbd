#include "oraclegs/capture/free_names.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(FreeNames, NumberWhatWasGivenBefore) {
  FreeNames names;
  names.Block("folder");
  EXPECT_EQ(names.Take("a.jpg"), "a.jpg");
  EXPECT_EQ(names.Take("a-2.jpg"), "a-2.jpg");
  EXPECT_EQ(names.Take("a.jpg"), "a-3.jpg");
  EXPECT_EQ(names.Take("a.jpg"), "a-4.jpg");
  EXPECT_EQ(names.Take("trip/a.jpg"), "trip/a.jpg");
  EXPECT_EQ(names.Take("trip/a.jpg"), "trip/a-2.jpg");
  EXPECT_EQ(names.Take("folder"), "folder-2");
}

TEST(FreeNames, DifferInMoreThanCase) {
  FreeNames names;
  EXPECT_EQ(names.Take("IMG.JPG"), "IMG.JPG");
  EXPECT_EQ(names.Take("img.jpg"), "img-2.jpg");
  EXPECT_EQ(names.Take("Img-2.jpg"), "Img-2-2.jpg");
}

TEST(FreeNames, TakeNoLongerWhenManyAreEqual) {
  FreeNames names;  // looking from the start each time, this takes minutes
  for (int i = 0; i < 100000; ++i) names.Take("a.jpg");
  EXPECT_EQ(names.Take("a.jpg"), "a-100001.jpg");
}

}  // namespace
}  // namespace oraclegs
