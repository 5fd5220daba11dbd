#include "oraclegs/core/memory.h"

#include <gtest/gtest.h>

#include <vector>

namespace oraclegs {
namespace {

TEST(AvailableMemory, IsWhatAMachineThatRunsTestsHas) {
  EXPECT_GT(AvailableMemory(), uint64_t{16} << 20);
  EXPECT_LT(AvailableMemory(), uint64_t{1} << 50);
}

TEST(PeakMemoryBytes, IsWhatWasTouchedAtLeast) {
  constexpr int64_t kBytes = int64_t{64} << 20;
  const std::vector<char> touched(kBytes, 1);
  EXPECT_GT(PeakMemoryBytes(), kBytes);
  EXPECT_EQ(touched.back(), 1);
}

}  // namespace
}  // namespace oraclegs
