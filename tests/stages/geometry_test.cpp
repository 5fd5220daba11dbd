#include "oraclegs/stages/geometry.h"

#include <gtest/gtest.h>

namespace oraclegs {
namespace {

TEST(Geometry, FreesColorsOfExposuresThatVary) {
  Geometry geometry;
  EXPECT_FALSE(geometry.HasVariedExposure());
  geometry.gains.assign(4, Eigen::Vector3f::Constant(1.01f));
  EXPECT_FALSE(geometry.HasVariedExposure());
  EXPECT_TRUE(FusionOf(geometry.gains).gains.empty());
  geometry.gains[1] = Eigen::Vector3f::Constant(1.5f);
  EXPECT_TRUE(geometry.HasVariedExposure());
  EXPECT_EQ(FusionOf(geometry.gains).gains.size(), 4u);
}

}  // namespace
}  // namespace oraclegs
