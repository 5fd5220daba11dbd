#include "oraclegs/train/loss_terms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "oraclegs/train/schedule.h"
#include "support/errors.h"
#include "train/small_scene.h"

namespace oraclegs {
namespace {

constexpr SampledView kPhoto{ViewKind::kPhoto, 0}, kProposal{ViewKind::kProposal, 0};

std::vector<TermKind> Kinds(const LossTerms& terms) {
  std::vector<TermKind> kinds;
  for (const LossTerm& term : terms) kinds.push_back(term.kind);
  return kinds;
}

/// A view with every plane that a view may have.
TrainView Complete(const std::string& name, uint64_t seed) {
  const Shape plane{kHeight, kWidth};
  TrainView view{name, CameraOnCircle(0.2), RandomUniform({kHeight, kWidth, 3}, 10 * seed),
                 RandomUniform(plane, 10 * seed + 1)};
  view.inv_depth = RandomUniform(plane, 10 * seed + 2);
  view.depth_mask = RandomUniform(plane, 10 * seed + 3);
  view.alpha = RandomUniform(plane, 10 * seed + 4);
  return view;
}

double NoDistance(const Buffer<float>&, const Buffer<float>&, double, Buffer<float>*) { return 0; }

TEST(LossPlan, GivesPhotosTheirTerms) {
  TrainOptions options = Options();
  options.exposure = ExposureMode::kOn;
  const LossPlan plan(options, {{Complete("photo", 2)}, {Complete("proposal", 3)}, NoDistance});
  const LossTerms terms = plan.Terms(kPhoto, 30);
  EXPECT_THAT(Kinds(terms),
              testing::ElementsAre(TermKind::kPhotometric, TermKind::kExposure, TermKind::kInvDepth, TermKind::kAlpha));
  EXPECT_EQ(terms.begin()[0].target, ViewPlane::kImage);
  EXPECT_EQ(terms.begin()[0].mask, ViewPlane::kPixelWeight);
  EXPECT_EQ(terms.begin()[0].mask_meaning, MaskMeaning::kMask);
  EXPECT_EQ(terms.begin()[0].photometric.dssim, 0.2f);
  EXPECT_EQ(terms.begin()[2].mask, ViewPlane::kDepthMask);
  EXPECT_EQ(terms.exposure, 0);
  EXPECT_EQ(terms.exposure_rate, ExposureLearningRate(30, options.iterations));
  EXPECT_EQ(plan.Terms(kPhoto, options.iterations).exposure_rate, 0);  // the last iteration moves no map
}

TEST(LossPlan, GivesProposalsTheirTerms) {
  TrainOptions options = Options();
  options.exposure = ExposureMode::kOn;
  const TrainView proposal = Complete("proposal", 3);
  const LossPlan plan(options, {{Complete("photo", 2)}, {proposal}, NoDistance});
  const LossTerms terms = plan.Terms(kProposal, 30);
  EXPECT_THAT(Kinds(terms), testing::ElementsAre(TermKind::kPhotometric, TermKind::kPerceptual, TermKind::kInvDepth,
                                                 TermKind::kAlpha));
  EXPECT_EQ(terms.begin()[0].mask_meaning, MaskMeaning::kConfidence);
  EXPECT_EQ(terms.begin()[0].photometric.l1, 0.4f);
  EXPECT_DOUBLE_EQ(terms.begin()[1].weight, 0.3 * MeanConfidence(proposal));
  EXPECT_FALSE(terms.exposure.has_value());
}

TEST(LossPlan, LeavesOutWhatAViewLacks) {
  const LossPlan plan(Options(), {Photos(1), Photos(1)});
  for (const SampledView& view : {kPhoto, kProposal}) {
    const LossTerms terms = plan.Terms(view, 30);
    EXPECT_THAT(Kinds(terms), testing::ElementsAre(TermKind::kPhotometric));
    EXPECT_EQ(terms.begin()[0].mask, ViewPlane::kNone);
  }
}

TEST(LossPlan, LeavesOutTermsOfNoWeight) {
  TrainOptions options = Options();
  options.depth_weight = options.alpha_weight = 0;
  TrainView unsure = Complete("proposal", 3);
  unsure.pixel_weight.SetZero();
  const LossPlan plan(options, {{Complete("photo", 2)}, {unsure}, NoDistance});
  for (const SampledView& view : {kPhoto, kProposal}) {
    EXPECT_THAT(Kinds(plan.Terms(view, 30)), testing::ElementsAre(TermKind::kPhotometric));
  }
}

TEST(LossPlan, GivesTheShareOfLpipsToL1WithoutANetwork) {
  const LossPlan plan(Options(), {Photos(1), Photos(1)});
  const PhotometricWeights weights = plan.Terms(kProposal, 1).begin()->photometric;
  EXPECT_EQ(weights.l1, 0.7f);
  EXPECT_EQ(weights.dssim, 0.3f);
}

TEST(LossPlan, LowersTheDepthWeightOverTheRun) {
  TrainOptions options = Options();
  options.depth_weight = 2;
  const TrainView photo = Complete("photo", 2);
  const LossPlan plan(options, std::vector<TrainView>{photo});
  const double scale = CharacteristicDepth({WithCleanDepth(photo)});
  for (const int64_t i : {1, 30, 100}) {
    EXPECT_DOUBLE_EQ(plan.Terms(kPhoto, i).begin()[1].weight, 2 * scale * DepthWeight(i, options.iterations)) << i;
  }
}

TEST(LossTerms, RefusesMoreThanItHolds) {
  LossTerms terms;
  for (int i = 0; i < LossTerms::kMaxTerms; ++i) terms.Add({TermKind::kAlpha});
  EXPECT_THROW(terms.Add({TermKind::kAlpha}), ShapeError);
}

TEST(LossPlan, RefusesViewsThatDoNotFit) {
  EXPECT_THROW(LossPlan(Options(), {{}, {Complete("proposal", 3)}}), UsageError);
  TrainView proposal = Complete("proposal", 3);
  Flat(proposal.pixel_weight) *= 2;
  EXPECT_THROW(LossPlan(Options(), {Photos(1), {proposal}}), ShapeError);
}

TEST(LossPlan, RefusesSharesOfMoreThanOne) {
  TrainOptions options = Options();
  options.proposal_ssim = 0.75, options.proposal_lpips = 0.5;
  EXPECT_THAT(MessageOf<UsageError>([&] { LossPlan(options, Photos(1)); }),
              testing::HasSubstr("--set proposal-ssim=0.75 and --set proposal-lpips=0.5 sum to 1.25"));
  options.proposal_lpips = 0.25;
  EXPECT_NO_THROW(LossPlan(options, Photos(1)));
}

}  // namespace
}  // namespace oraclegs
