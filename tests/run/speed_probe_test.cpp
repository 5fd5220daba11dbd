#include "oraclegs/run/speed_probe.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(CpuSlowness, IsMeasuredOnce) {
  const double slowness = CpuSlowness();
  EXPECT_GT(slowness, 0);
  EXPECT_EQ(CpuSlowness(), slowness);
}

}  // namespace
}  // namespace oraclegs
