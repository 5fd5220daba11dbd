#include "oraclegs/propose/ensemble.h"

#include <gtest/gtest.h>

#include "oraclegs/gaussians/initialize.h"

namespace oraclegs {
namespace {

/// One wide blob of a colour before the camera.
Gaussians Blob(float red) {
  PointCloud cloud;
  for (int i = 0; i < 5; ++i) {
    cloud.xyz.emplace_back(0.1f * static_cast<float>(i % 2), 0.1f * static_cast<float>(i / 2), 2.f);
    cloud.rgb.emplace_back(red, 0.f, 0.f);
  }
  return InitializeGaussians(cloud, {20, 0.99, 1});
}

Target Front() {
  Target target{"t", {}};
  target.camera.width = 8, target.camera.height = 6;
  target.camera.fx = target.camera.fy = 8, target.camera.cx = 4, target.camera.cy = 3;
  return target;
}

constexpr size_t kMiddle = 3 * 8 + 4;

/// Each was darker before it was trained with all views.
EnsembleProposer ProposerOf(const std::vector<float>& reds) {
  std::vector<ProxyModel> members;
  for (size_t k = 0; k < reds.size(); ++k) {
    members.push_back({Blob(reds[k] - 0.1f), Blob(reds[k]), {static_cast<int>(k)}});
  }
  return {std::move(members), RenderOptions{{0, 0, 0}, 0}};
}

TEST(EnsembleProposer, GivesTheMeanOfWhatIsFinished) {
  const auto proposal = ProposerOf({0.4f, 0.6f}).Propose(Front(), std::nullopt);
  ASSERT_TRUE(proposal.has_value());
  EXPECT_EQ(proposal->source, "splat");
  EXPECT_NEAR(proposal->rgb.data[3 * kMiddle], 0.5f, 0.02f);
  EXPECT_NEAR(proposal->inv_depth[kMiddle], 0.5f, 0.05f);
  EXPECT_TRUE(proposal->spread.empty()) << "no view is held out from two";
}

TEST(EnsembleProposer, MeasuresTheSpreadOfLeaveOutModels) {
  std::vector<ProxyModel> members;
  members.push_back({Blob(0.4f), Blob(0.9f), {0, 1}});
  members.push_back({Blob(0.6f), std::nullopt, {0, 2}});
  members.push_back({Blob(0.5f), std::nullopt, {1, 2}});
  const EnsembleProposer proposer(std::move(members), RenderOptions{{0, 0, 0}, 0});
  const auto proposal = proposer.Propose(Front(), std::nullopt);
  EXPECT_NEAR(proposal->rgb.data[3 * kMiddle], 0.9f, 0.02f) << "the only one that went on";
  EXPECT_NEAR(proposal->spread[kMiddle], 0.1f / std::sqrt(3.f), 0.01f) << "red is one channel of three";
  const auto held_out = proposer.Propose(Front(), 0);
  EXPECT_NEAR(held_out->rgb.data[3 * kMiddle], 0.5f, 0.02f);
  EXPECT_NEAR(held_out->spread[kMiddle], 0.1f * std::sqrt(2.f / 3.f), 0.01f);
}

TEST(EnsembleProposer, TrimsExtremesOfFour) {
  const auto proposal = ProposerOf({0.4f, 0.6f, 0.5f, 1.f}).Propose(Front(), std::nullopt);
  EXPECT_NEAR(proposal->rgb.data[3 * kMiddle], 0.55f, 0.02f);
}

TEST(EnsembleProposer, ShowsHeldOutViewByLeaveOutModels) {
  const EnsembleProposer proposer = ProposerOf({0.2f, 0.8f});
  const auto proposal = proposer.Propose(Front(), 1);
  ASSERT_TRUE(proposal.has_value());
  EXPECT_NEAR(proposal->rgb.data[3 * kMiddle], 0.7f, 0.02f);
  EXPECT_TRUE(proposal->spread.empty());
  EXPECT_FALSE(proposer.Propose(Front(), 2).has_value());
}

/// From how many of the members each view is held out.
std::vector<int> LeaveOuts(int views, int members) {
  std::vector<int> count(static_cast<size_t>(views));
  for (int k = 0; k < members; ++k) {
    for (const int v : HeldOutViews(views, members, k)) ++count[static_cast<size_t>(v)];
  }
  return count;
}

TEST(HeldOutViews, HoldsEachViewOutFromHalfOfTheMembers) {
  EXPECT_EQ(LeaveOuts(10, 4), std::vector<int>(10, 2));
  EXPECT_EQ(LeaveOuts(8, 5), std::vector<int>(8, 2));
  EXPECT_EQ(LeaveOuts(9, 3), std::vector<int>(9, 1));
  EXPECT_EQ(HeldOutViews(8, 4, 1), (std::vector<int>{0, 1, 4, 5}));
}

TEST(HeldOutViews, HoldsFewViewsOutOnce) {
  EXPECT_EQ(LeaveOuts(7, 4), std::vector<int>(7, 1));
  EXPECT_EQ(HeldOutViews(3, 3, 2), std::vector<int>{2});
  EXPECT_TRUE(HeldOutViews(10, 1, 0).empty());
}

}  // namespace
}  // namespace oraclegs
