#include "oraclegs/core/memory.h"

#include <gtest/gtest.h>

#include <vector>

namespace oraclegs {
namespace {

TEST(AvailableMemory, IsWhatAMachineThatRunsTestsHas) {
  EXPECT_GT(AvailableMemory(), uint64_t{16} << 20);
  EXPECT_LT(AvailableMemory(), uint64_t{1} << 50);
}

}  // namespace
}  // namespace oraclegs
