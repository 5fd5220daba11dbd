#include "oraclegs/loss/objective.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/tensors.h"

namespace oraclegs {
namespace {

/// Golden pictures are [3,H,W].
Buffer<float> Interleaved(const Buffer<float>& planes) { return planes.permute({1, 2, 0}); }

class ObjectiveGoldenTest : public testing::Test {
 protected:
  double Number(const std::string& name) const { return GoldenTensor(file, name).item<double>(); }
  Buffer<float> Picture(const std::string& name) const { return Interleaved(GoldenTensor(file, name)); }

  const SafetensorsFile file = OpenGolden("ssim");
  const Buffer<float> render = Interleaved(GoldenFloat(file, "render"));
  const Buffer<float> target = Interleaved(GoldenFloat(file, "target"));
  const Buffer<float> confidence = GoldenFloat(file, "confidence");
  Buffer<float> grad = torch::full_like(render, std::nanf(""));  // every entry must be written
};

/// A stand-in that is easy to differentiate: mean (render - target)^2.
double MeanSquare(const Buffer<float>& render, const Buffer<float>& target, double weight, Buffer<float>* grad) {
  const Buffer<float> difference = render - target;
  if (grad != nullptr && grad->defined()) *grad += 2 * weight / static_cast<double>(render.count()) * difference;
  return difference.to(torch::kDouble).square().mean().item<double>();
}

TEST_F(ObjectiveGoldenTest, PhotographsAreL1AndSsim) {
  EXPECT_NEAR(Objective({}).Photograph(render, target, {}, &grad), Number("loss_photograph"), 2e-6);
  EXPECT_LE(RelativeL2(grad, Picture("grad_loss_photograph")), 5e-5);
}

TEST_F(ObjectiveGoldenTest, WithLpipsProposalsKeepItsShareOutOfL1) {
  Objective objective({}, [](auto&&...) { return 0.; });
  EXPECT_TRUE(objective.has_lpips());
  EXPECT_NEAR(objective.Proposal(render, target, confidence, &grad), Number("loss_proposal"), 2e-6);
  EXPECT_LE(RelativeL2(grad, Picture("grad_loss_proposal")), 5e-5);
}

TEST_F(ObjectiveGoldenTest, WithoutLpipsItsShareGoesToL1) {
  Objective objective({});
  EXPECT_FALSE(objective.has_lpips());
  EXPECT_NEAR(objective.Proposal(render, target, confidence, &grad),
              0.7 * Number("l1_weighted") + 0.3 * Number("dssim_weighted"), 2e-6);
  EXPECT_LE(RelativeL2(grad, 0.7 * Picture("grad_l1_weighted") + 0.3 * Picture("grad_dssim_weighted")), 5e-5);
}

TEST_F(ObjectiveGoldenTest, LpipsIsWeighedByTheMeanConfidence) {
  const double mean = confidence.to(torch::kDouble).mean().item<double>();
  const Buffer<float> difference = (render - target).to(torch::kDouble);
  const double square = difference.square().mean().item<double>();
  Objective objective({}, MeanSquare);
  EXPECT_NEAR(objective.Proposal(render, target, confidence, &grad), Number("loss_proposal") + 0.3 * mean * square,
              2e-6);
  const Buffer<float> pull = 0.3 * mean * 2 / static_cast<double>(render.count()) * difference;
  EXPECT_LE(RelativeL2(grad, Picture("grad_loss_proposal") + pull), 5e-5);

  Buffer<float> none;
  EXPECT_NEAR(objective.Proposal(render, target, {}, &none),
              0.4 * Number("l1") + 0.3 * (1 - Number("ssim")) + 0.3 * square, 2e-6);
}

TEST_F(ObjectiveGoldenTest, TheFactorIsOfAProposalsWholeLoss) {
  ObjectiveWeights weights;
  Objective one(weights, MeanSquare);
  Buffer<float> expected = Buffer<float>::Empty(render.shape());
  const double loss = one.Proposal(render, target, confidence, &expected);
  weights.proposal = 2.5;
  Objective more(weights, MeanSquare);
  EXPECT_NEAR(more.Proposal(render, target, confidence, &grad), 2.5 * loss, 1e-6);
  EXPECT_LE(RelativeL2(grad, 2.5 * expected.to(torch::kDouble)), 1e-6);
  Buffer<float> none;
  EXPECT_EQ(more.Photograph(render, target, {}, &none), one.Photograph(render, target, {}, &none));
  weights.proposal = 0;
  EXPECT_EQ(Objective(weights, MeanSquare).Proposal(render, target, confidence, &grad), 0);
  EXPECT_EQ(grad.abs().max().item<float>(), 0);
}

TEST_F(ObjectiveGoldenTest, AProposalWithoutConfidenceNeitherCostsNorPullsNorAsksTheNetwork) {
  bool asked = false;
  Objective objective({}, [&](auto&&...) {
    asked = true;
    return 1.;
  });
  EXPECT_EQ(objective.Proposal(render, target, torch::zeros_like(confidence), &grad), 0);
  EXPECT_EQ(grad.abs().max().item<float>(), 0);
  EXPECT_FALSE(asked);
}

TEST_F(ObjectiveGoldenTest, WhatAMaskHidesHasNoSay) {
  Buffer<float> mask = torch::ones_like(confidence);
  mask.narrow(1, 20, 10).SetZero();
  Buffer<float> other = render.Clone(), none;
  other.narrow(1, 20, 10).fill_(9);
  Objective objective({});
  Buffer<float> expected = Buffer<float>::Empty(render.shape());
  const double loss = objective.Photograph(render, target, mask, &expected);
  EXPECT_EQ(objective.Photograph(other, target, mask, &grad), loss);
  EXPECT_EQ(objective.Photograph(other, target, mask, &none), loss);
  EXPECT_TRUE(torch::equal(grad, expected));
  EXPECT_EQ(grad.narrow(1, 20, 10).abs().max().item<float>(), 0);
  EXPECT_GT(grad.narrow(1, 0, 20).abs().max().item<float>(), 0);
}

TEST(ObjectiveTest, RefusesWhatDoesNotFit) {
  const Buffer<float> image = torch::rand({8, 9, 3});
  Buffer<float> none;
  EXPECT_THROW(Objective({}).Photograph(image, image, Buffer<float>::Full({9, 8}, 1.f), &none), ShapeError);
  EXPECT_THROW(Objective({}).Photograph(image, torch::rand({9, 8, 3}), Buffer<float>::Full({8, 9}, 1.f), &none), ShapeError);
  EXPECT_THROW(Objective({}).Photograph(torch::rand({8, 9}), image, Buffer<float>::Full({8, 9}, 1.f), &none), ShapeError);
  EXPECT_THROW(Objective({}).Proposal(image, image, Buffer<float>::Full({9, 8}, 1.f), &none), ShapeError);
  try {
    Objective({0.2, 0.75, 0.5, 1});
    ADD_FAILURE() << "shares of more than 1 were accepted";
  } catch (const UsageError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("--proposal-ssim 0.75 and --proposal-lpips 0.5 sum to 1.25"));
  }
  EXPECT_NO_THROW(Objective({0.2, 0.7, 0.3, 1}));
}

}  // namespace
}  // namespace oraclegs
