#include <gtest/gtest.h>

#include "oraclegs/validate/oracle.h"

namespace oraclegs {
namespace {

TEST(UniformOracle, TrustsEveryPixelOfEveryProposal) {
  Proposal wide, tall;
  wide.camera.width = 3, wide.camera.height = 2;
  tall.camera.width = 1, tall.camera.height = 5;
  const auto maps = MakeUniformOracle()->Predict(std::vector<Proposal>{wide, tall});
  ASSERT_EQ(maps.size(), 2u);
  EXPECT_EQ(maps[0], ConfidenceMap(6, 1.f));
  EXPECT_EQ(maps[1], ConfidenceMap(5, 1.f));
}

}  // namespace
}  // namespace oraclegs
