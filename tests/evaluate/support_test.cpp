#include "oraclegs/evaluate/support.h"

#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/camera/camera_path.h"
#include "oraclegs/core/error.h"

namespace oraclegs {
namespace {

Camera LookingAtOrigin(const Eigen::Vector3d& center) {
  Camera camera;
  camera.width = camera.height = 64;
  camera.fx = camera.fy = 60;
  camera.cx = camera.cy = 32;
  camera.cam_from_world = LookAt(center, Eigen::Vector3d::Zero(), Eigen::Vector3d(0, -1, 0));
  return camera;
}

SupportView ImageFrom(const Eigen::Vector3d& center) { return {LookingAtOrigin(center), {}, false}; }

SupportView ProposalFrom(const Eigen::Vector3d& center, float confidence) {
  SupportView view{LookingAtOrigin(center), Buffer<float>::Empty({64, 64}), true};
  std::fill_n(view.weight.data(), view.weight.count(), confidence);
  return view;
}

/// Balls of standard deviation 0.2 and opacity 0.95.
Gaussians Balls(const std::vector<Eigen::Vector3f>& centers) {
  Gaussians g = Gaussians::Zeros(static_cast<int64_t>(centers.size()));
  for (size_t i = 0; i < centers.size(); ++i) {
    const GaussianRows row = g.Rows().From(static_cast<int64_t>(i));
    Eigen::Map<Eigen::Vector3f>(row.means) = centers[i];
    std::fill_n(row.log_scales, 3, std::log(0.2f));
    row.quats[0] = 1;
    row.opacity_logits[0] = 3;
  }
  return g;
}

const Eigen::Vector3d kFront{0, 0, -3}, kLeft{-3, 0, 0}, kRight{3, 0, 0};

TEST(Support, RisesWithTheImagesThatSeeAGaussian) {
  const Gaussians ball = Balls({{0, 0, 0}});
  const float none = Support(ball, {}, {})[0], one = Support(ball, {ImageFrom(kFront)}, {})[0],
              two = Support(ball, {ImageFrom(kFront), ImageFrom(kLeft)}, {})[0],
              three = Support(ball, {ImageFrom(kFront), ImageFrom(kLeft), ImageFrom(kRight)}, {})[0];
  EXPECT_EQ(none, 0);
  EXPECT_GE(one, 0.5f);
  EXPECT_LT(one, 0.75f);
  EXPECT_GE(two, 0.75f);
  EXPECT_GT(three, two);
  EXPECT_LE(three, 1);
}

TEST(Support, IsTheConfidenceOfProposalsWhereNoImageSees) {
  const Gaussians ball = Balls({{0, 0, 0}});
  EXPECT_NEAR(Support(ball, {ProposalFrom(kFront, 0.8f)}, {})[0], 0.4, 1e-3);
  const SupportView in_bytes{LookingAtOrigin(kFront), {}, true, Buffer<uint8_t>::Full({64, 64}, 204)};
  EXPECT_NEAR(Support(ball, {in_bytes}, {})[0], 0.4, 1e-3);
  EXPECT_NEAR(Support(ball, {ProposalFrom(kFront, 0.2f)}, {})[0], 0.1, 1e-3);
  EXPECT_NEAR(Support(ball, {ProposalFrom(kFront, 0.2f), ProposalFrom(kLeft, 0.6f)}, {})[0], 0.3, 1e-3);
  EXPECT_LT(Support(ball, {ProposalFrom(kFront, 1)}, {})[0], 0.5f);
}

TEST(Support, OccludedGaussiansAreNotSeen) {
  // Four balls in a row along z: the last hides behind the others from the front, not from the left.
  const Gaussians row = Balls({{0, 0, -1}, {0, 0, -0.7f}, {0, 0, -0.4f}, {0, 0, 0.5f}});
  const std::vector<float> front = Support(row, {ImageFrom(kFront)}, {});
  EXPECT_GE(front[0], 0.5f);
  EXPECT_EQ(front[3], 0);
  EXPECT_GE(Support(row, {ImageFrom(kFront), ImageFrom(kLeft)}, {})[3], 0.5f);
}

TEST(Support, MaskedAndOutsidePixelsDoNotCount) {
  SupportView masked = ImageFrom(kFront);
  masked.weight = Buffer<float>::Zeros({64, 64});
  EXPECT_EQ(Support(Balls({{0, 0, 0}}), {masked}, {})[0], 0);
  EXPECT_EQ(Support(Balls({{5, 0, 0}}), {ImageFrom(kFront)}, {})[0], 0);
  EXPECT_EQ(Support(Balls({{0, 0, -6}}), {ImageFrom(kFront)}, {})[0], 0);  // behind the camera
}

TEST(Support, RefusesAWeightOfAnotherSize) {
  SupportView view = ImageFrom(kFront);
  view.weight = Buffer<float>::Zeros({32, 64});
  EXPECT_THROW(Support(Balls({{0, 0, 0}}), {view}, {}), ShapeError);
}

}  // namespace
}  // namespace oraclegs
