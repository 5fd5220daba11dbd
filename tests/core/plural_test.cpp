#include "oraclegs/core/plural.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(Counted, HasAnSUnlessThereIsOne) {
  EXPECT_EQ(Counted(0, "test view"), "0 test views");
  EXPECT_EQ(Counted(1, "test view"), "1 test view");
  EXPECT_EQ(Counted(size_t{12}, "photo"), "12 photos");
}

}  // namespace
}  // namespace oraclegs
