#include "oraclegs/depth/depth_map.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(ConfidentShare, IncludesThreshold) {
  DepthMap map;
  EXPECT_EQ(ConfidentShare(map), 0) << "of no pixels at all";
  map.inv_depth = {1, 1, 1, 1};
  map.confidence = {0, kConfident, 0.99f * kConfident, 1};
  EXPECT_EQ(map.size(), 4u);
  EXPECT_EQ(ConfidentShare(map), 0.5);
}

}  // namespace
}  // namespace oraclegs
