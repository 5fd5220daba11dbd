#include "oraclegs/propose/ensemble.h"

#include <gtest/gtest.h>

#include "oraclegs/gaussians/initialize.h"

namespace oraclegs {
namespace {

/// One wide blob of a color before the camera.
Gaussians Blob(float red) {
  PointCloud cloud;
  for (int i = 0; i < 5; ++i) {
    cloud.xyz.emplace_back(0.1f * static_cast<float>(i % 2), 0.1f * static_cast<float>(i / 2), 2.f);
    cloud.rgb.emplace_back(red, 0.f, 0.f);
  }
  return InitializeGaussians(cloud, {20, 0.99});
}

Target Front() {
  Target target{"t", {}};
  target.camera.width = 8, target.camera.height = 6;
  target.camera.fx = target.camera.fy = 8, target.camera.cx = 4, target.camera.cy = 3;
  return target;
}

/// Members of these reds, each darker before it was trained with all views.
EnsembleProposer ProposerOf(const std::vector<float>& reds) {
  std::vector<ProxyModel> members;
  for (size_t k = 0; k < reds.size(); ++k) {
    members.push_back({Blob(reds[k] - 0.1f), Blob(reds[k]), {static_cast<int>(k)}});
  }
  return {std::move(members), RenderOptions{{0, 0, 0}, 0}};
}

TEST(EnsembleProposer, GivesMeanAndSpread) {
  const auto proposal = ProposerOf({0.4f, 0.6f}).Propose(Front(), std::nullopt);
  ASSERT_TRUE(proposal.has_value());
  EXPECT_EQ(proposal->source, "proxies");
  const size_t middle = 3 * 8 + 4;
  EXPECT_NEAR(proposal->rgb.data[3 * middle], 0.5f, 0.02f);
  EXPECT_NEAR(proposal->spread[middle], 0.1f / std::sqrt(3.f), 0.01f);
  EXPECT_NEAR(proposal->inv_depth[middle], 0.5f, 0.05f);
}

TEST(EnsembleProposer, TrimsExtremesOfFour) {
  const auto proposal = ProposerOf({0.4f, 0.6f, 0.5f, 1.f}).Propose(Front(), std::nullopt);
  EXPECT_NEAR(proposal->rgb.data[3 * (3 * 8 + 4)], 0.55f, 0.02f);
}

TEST(EnsembleProposer, ShowsHeldOutViewByLeaveOutModels) {
  const EnsembleProposer proposer = ProposerOf({0.2f, 0.8f});
  const auto proposal = proposer.Propose(Front(), 1);
  ASSERT_TRUE(proposal.has_value());
  EXPECT_NEAR(proposal->rgb.data[3 * (3 * 8 + 4)], 0.7f, 0.02f);
  EXPECT_TRUE(proposal->spread.empty());
  EXPECT_FALSE(proposer.Propose(Front(), 2).has_value());
}

TEST(HeldOutViews, HoldsEachViewOutOnce) {
  std::vector<int> all;
  for (int k = 0; k < 4; ++k) {
    for (const int v : HeldOutViews(10, 4, k)) all.push_back(v);
  }
  std::sort(all.begin(), all.end());
  EXPECT_EQ(all, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_TRUE(HeldOutViews(10, 1, 0).empty());
}

}  // namespace
}  // namespace oraclegs
