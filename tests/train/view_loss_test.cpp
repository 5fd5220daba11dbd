#include "oraclegs/train/view_loss.h"

#include <cmath>

#include "oraclegs/loss/masked_l1.h"
#include "oraclegs/train/schedule.h"
#include "support/buffers.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

using testing::HasSubstr;

constexpr SampledView kPhotograph{ViewKind::kPhotograph, 0}, kProposal{ViewKind::kProposal, 0};

/// A view of noise, with confidence and depth.
TrainView Noise(const std::string& name, uint64_t seed) {
  TrainView view{name, CameraOnCircle(0.2), RandomUniform({kHeight, kWidth, 3}, 10 * seed),
                 RandomUniform({kHeight, kWidth}, 10 * seed + 1)};
  view.inv_depth = RandomUniform({kHeight, kWidth}, 10 * seed + 2);
  view.depth_mask = RandomUniform({kHeight, kWidth}, 10 * seed + 3);
  return view;
}

RenderOutput Render() {
  return {RandomUniform({kHeight, kWidth, 3}, 119), RandomUniform({kHeight, kWidth}, 120),
          RandomUniform({kHeight, kWidth}, 121)};
}

TEST(ViewLossTest, AProposalsIsWeighedByConfidenceAndHasDepthOfItsMask) {
  TrainOptions options = Options();
  options.depth_weight = 2;
  const TrainView photograph = Photographs(1)[0], proposal = Noise("proposal", 3);
  const RenderOutput out = Render();
  ViewLoss loss(options, {{photograph}, {proposal}});
  const ViewLossResult result = loss(kProposal, 30, out);

  Buffer<float> grad = Buffer<float>::Empty(out.image.shape()),
                grad_depth = Buffer<float>::Empty(out.inv_depth.shape());
  const double picture = PhotometricLoss()(out.image, proposal.image, proposal.confidence, {0.7f, 0.3f}, &grad).loss;
  const double weight = 2 * CharacteristicDepth({proposal}) * DepthWeight(30, options.iterations);
  const double depth = MaskedL1(out.inv_depth, proposal.inv_depth, proposal.depth_mask, weight, &grad_depth);
  EXPECT_GT(depth, 0);
  EXPECT_DOUBLE_EQ(result.loss, picture + depth);
  EXPECT_TRUE(Equal(result.grads.image, grad));
  EXPECT_TRUE(Equal(result.grads.inv_depth, grad_depth));
  EXPECT_FALSE(result.grads.alpha.defined());

  options.proposal_weight = 0.5;
  ViewLoss half(options, {{photograph}, {proposal}});
  EXPECT_NEAR(half(kProposal, 30, out).loss, (picture + depth) / 2, 1e-9);
}

TEST(ViewLossTest, AlphaCountsWhereThePhotographDoes) {
  TrainOptions options = Options();
  options.alpha_weight = 0.4;
  TrainView photograph = Photographs(1)[0];
  photograph.confidence = Above(RandomUniform({kHeight, kWidth}, 122), 0.3f);
  const RenderOutput out = Render();
  const double without = ViewLoss(options, {{photograph}})(kPhotograph, 1, out).loss;
  photograph.alpha = RandomUniform({kHeight, kWidth}, 123);
  ViewLoss loss(options, {{photograph}});
  const ViewLossResult result = loss(kPhotograph, 1, out);
  Buffer<float> grad = Buffer<float>::Empty(out.alpha.shape());
  const double alpha = MaskedL1(out.alpha, photograph.alpha, photograph.confidence, 0.4, &grad);
  EXPECT_GT(alpha, 0);
  EXPECT_DOUBLE_EQ(result.loss, without + alpha);
  EXPECT_TRUE(Equal(result.grads.alpha, grad));
  options.alpha_weight = 0;
  ViewLoss off(options, {{photograph}});
  EXPECT_FALSE(off(kPhotograph, 1, out).grads.alpha.defined());
}

TEST(ViewLossTest, ThePhotographsSayWhatDistancesTheSceneHas) {
  TrainView photograph = Noise("photo", 2), proposal = Noise("proposal", 3);
  Flat(photograph.inv_depth).setConstant(0.125);
  Flat(proposal.inv_depth).setConstant(0.5);
  const RenderOutput out = Render();
  const auto depth_part = [&](const TrainingData& data) {
    TrainOptions options = Options();
    const double with = ViewLoss(options, data)(kProposal, 1, out).loss;
    options.depth_weight = 0;
    return with - ViewLoss(options, data)(kProposal, 1, out).loss;
  };
  const double far = depth_part({{photograph}, {proposal}}), near = depth_part({{Photographs(1)[0]}, {proposal}});
  EXPECT_NEAR(far, 4 * near, 1e-6 * far);
}

TEST(ViewLossTest, WhatTheGateStopsHasNeitherColourNorDepth) {
  TrainOptions options = Options();
  options.confidence_gate = 0.5;
  options.confidence_power = 2;
  TrainView proposal = Noise("proposal", 3);
  const RenderOutput out = Render();
  ViewLoss loss(options, {{Photographs(1)[0]}, {proposal}});
  const ViewLossResult result = loss(kProposal, 1, out);
  const Eigen::ArrayXf passes = (Flat(proposal.confidence) >= 0.5f).cast<float>();
  EXPECT_EQ((Flat(result.grads.inv_depth) * (1 - passes)).abs().maxCoeff(), 0);
  EXPECT_GT((Flat(result.grads.inv_depth) * passes).abs().maxCoeff(), 0);
  Buffer<float> grad = Buffer<float>::Empty(out.image.shape());
  const Buffer<float> gated = ToBuffer(proposal.confidence.shape(), Flat(proposal.confidence).square() * passes);
  PhotometricLoss()(out.image, proposal.image, gated, {0.7f, 0.3f}, &grad);
  EXPECT_LE(MaxAbsError(result.grads.image, grad), 1e-9);
  EXPECT_TRUE(Equal(loss.View(kProposal, 1).image, proposal.image));
}

TEST(ViewLossTest, ProposalsAreInTheMeanExposure) {
  TrainOptions options = Options();
  options.exposure = ExposureMode::kOn;
  auto photographs = Photographs(2);
  photographs[0].exposure = {1.5f, 0, 0, 0, 0, 1.5f, 0, 0, 0, 0, 1.5f, 0};
  const TrainView proposal = Noise("proposal", 3);
  const RenderOutput out = Render();
  ViewLoss exposed(options, {photographs, {proposal}});
  options.exposure = ExposureMode::kOff;
  ViewLoss plain(options, {photographs, {proposal}});
  ASSERT_NE(exposed.exposures(), nullptr);
  EXPECT_EQ(plain.exposures(), nullptr);
  const std::vector<ExposureMap> before = exposed.exposures()->maps();
  EXPECT_EQ(exposed(kProposal, 1, out).loss, plain(kProposal, 1, out).loss);
  EXPECT_EQ(exposed.exposures()->maps(), before);
  EXPECT_NE(exposed(kPhotograph, 1, out).loss, plain(kPhotograph, 1, out).loss);
  EXPECT_NE(exposed.exposures()->maps(), before);
}

TEST(ViewLossTest, TheFirstIterationsSeeHalfTheSize) {
  TrainOptions options = Options(40);
  options.coarse_share = 0.5;
  ViewLoss loss(options, {Photographs(2), {Noise("proposal", 3)}});
  for (const SampledView& view : {kPhotograph, kProposal}) {
    EXPECT_EQ(loss.View(view, 20).camera.width, (kWidth + 1) / 2);
    EXPECT_EQ(loss.View(view, 20).image.size(0), (kHeight + 1) / 2);
    EXPECT_EQ(loss.View(view, 21).camera.width, kWidth);
  }
  EXPECT_EQ(loss.View(kProposal, 1).name, "proposal");
  EXPECT_EQ(loss.View(kProposal, 1).confidence.size(1), (kWidth + 1) / 2);
}

TEST(ViewLossTest, NotFiniteLossNamesIterationAndView) {
  TrainView proposal = Noise("proposal7", 3);
  proposal.image[(3 * kWidth + 4) * 3] = std::nanf("");
  ViewLoss loss(Options(), {Photographs(1), {proposal}});
  try {
    loss(kProposal, 12, Render());
    ADD_FAILURE() << "a loss that is not a number was accepted";
  } catch (const RunError& e) {
    EXPECT_THAT(e.what(), HasSubstr("iteration 12 on proposal7"));
  }
}

TEST(ViewLossTest, RefusesWhatDoesNotFit) {
  EXPECT_THROW(ViewLoss(Options(), {{}, {Noise("proposal", 3)}}), UsageError);
  TrainView proposal = Noise("proposal", 3);
  Flat(proposal.confidence) *= 2;
  EXPECT_THROW(ViewLoss(Options(), {Photographs(1), {proposal}}), ShapeError);
}

}  // namespace
}  // namespace oraclegs
