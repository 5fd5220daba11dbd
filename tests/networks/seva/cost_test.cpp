#include "bench/networks/seva_cost.h"

#include "networks/fixtures.h"

namespace oraclegs::seva {
namespace {

TEST(SevaCost, IsWhatTheSpecificationCounts) {
  ListedParameters listed;
  const Unet unet = LoadUnet(listed, UnetConfig());
  EXPECT_NEAR(CostOfStep(unet, 21, 72, 72).total, 76.9e12, 0.05e12);
  EXPECT_NEAR(CostOfStep(unet, 80, 72, 72).total, 430.5e12, 0.05e12);
  EXPECT_NEAR(CostOfStep(unet, 21, 72, 112).total, 137.3e12, 0.05e12);
  EXPECT_NEAR(CostOfStep(unet, 80, 72, 112).total, 855.7e12, 0.05e12);
}

TEST(SevaCost, KnowsTheShareOfJointAttention) {
  ListedParameters listed;
  const Unet unet = LoadUnet(listed, UnetConfig());
  // 165 at half resolution; at a quarter and an eighth of the sides a little more.
  const double joint = CostOfStep(unet, 80, 72, 72).joint_attention;
  EXPECT_GE(joint, 165e12);
  EXPECT_LE(joint, 200e12);
}

}  // namespace
}  // namespace oraclegs::seva
