#include "oraclegs/validate/features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace oraclegs {
namespace {

constexpr int kWidth = 24, kHeight = 18;

size_t Named(const char* name) {
  const auto found = std::find_if(kFeatureNames.begin(), kFeatureNames.end(),
                                  [&](const char* other) { return std::strcmp(name, other) == 0; });
  EXPECT_NE(found, kFeatureNames.end());
  return static_cast<size_t>(found - kFeatureNames.begin());
}

/// A picture with texture that the photographs agree with.
class FeaturesTest : public testing::Test {
 protected:
  FeaturesTest() {
    proposal.camera.width = kWidth, proposal.camera.height = kHeight;
    proposal.rgb = {kWidth, kHeight, 3, {}};
    for (int i = 0; i < kWidth * kHeight; ++i) {
      for (int c = 0; c < 3; ++c) proposal.rgb.data.push_back(i * 37 % 11 / 11.f);
    }
    warped.rgb = proposal.rgb;
    warped.inv_depth.assign(kWidth * kHeight, 0.5f);
    warped.evidence.resize(kWidth * kHeight);
  }
  Features At(int x, int y) const { return FeaturesOf(proposal, warped)[static_cast<size_t>(y * kWidth + x)]; }

  Proposal proposal;
  WarpedView warped;
};

TEST_F(FeaturesTest, SeeWhereColorsDiffer) {
  const size_t color = Named("color"), around = Named("color around"), structure = Named("structure");
  const Features before = At(12, 9);
  EXPECT_NEAR(before[structure], 0, 1e-4);
  for (int c = 0; c < 3; ++c) proposal.rgb.row(9)[3 * 12 + c] += 0.5f;
  EXPECT_GT(At(12, 9)[color], before[color] + 1);
  EXPECT_EQ(At(13, 9)[color], before[color]);
  EXPECT_GT(At(13, 9)[around], before[around]);
  EXPECT_GT(At(13, 9)[structure], 0.01f);
  EXPECT_NEAR(At(22, 2)[around], before[around], 1e-5f);
}

TEST_F(FeaturesTest, SeeDepthsThatDiffer) {
  const size_t depth = Named("depth"), edge = Named("depth edge");
  proposal.inv_depth.assign(kWidth * kHeight, 0.5f);
  const Features same = At(12, 9);
  proposal.inv_depth[9 * kWidth + 12] = 0.6f;
  EXPECT_GT(At(12, 9)[depth], same[depth] + 1);
  warped.inv_depth[9 * kWidth + 14] = 0.1f;
  EXPECT_GT(At(12, 9)[edge], same[edge] + 1);
  EXPECT_EQ(At(5, 9)[edge], same[edge]);
}

TEST_F(FeaturesTest, AreFiniteForTheWorstEvidence) {
  PixelEvidence& e = warped.evidence[5];
  e.ring = 1e9f, e.spread = 1e9f, e.angle = 1e9f, e.conflicts = 1e9f;
  warped.inv_depth.assign(kWidth * kHeight, 0.f);
  proposal.inv_depth.assign(kWidth * kHeight, 1e-30f);
  for (const Features& f : FeaturesOf(proposal, warped)) {
    for (const float value : f) EXPECT_TRUE(std::isfinite(value));
  }
}

}  // namespace
}  // namespace oraclegs
