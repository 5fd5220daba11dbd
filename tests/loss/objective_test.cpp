#include "oraclegs/loss/objective.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/buffers.h"
#include "support/errors.h"

namespace oraclegs {
namespace {

class ObjectiveGoldenTest : public testing::Test {
 protected:
  double Number(const std::string& name) const { return GoldenDouble(file, name)[0]; }
  Eigen::ArrayXd Image(const std::string& name) const { return Wide(Interleaved(GoldenDouble(file, name))); }
  double ErrorOfGrad(const Eigen::ArrayXd& expected) const { return RelativeL2(grad, expected); }

  const SafetensorsFile file = OpenGolden("ssim");  // its images are [3,H,W]
  const Buffer<float> render = Interleaved(GoldenFloat(file, "render"));
  const Buffer<float> target = Interleaved(GoldenFloat(file, "target"));
  const Buffer<float> confidence = GoldenFloat(file, "confidence");
  Buffer<float> grad = Buffer<float>::Full(render.shape(), std::nanf(""));  // every entry must be written
};

/// A stand-in for LPIPS that is easy to differentiate: mean (render - target)^2.
double MeanSquare(const Buffer<float>& render, const Buffer<float>& target, double weight, Buffer<float>* grad) {
  const Eigen::ArrayXd difference = Wide(render) - Wide(target);
  if (grad != nullptr && grad->defined()) {
    Flat(*grad) += (2 * weight / static_cast<double>(render.count()) * difference).cast<float>();
  }
  return difference.square().mean();
}

TEST_F(ObjectiveGoldenTest, PhotosAreL1AndSsim) {
  EXPECT_NEAR(Objective({}).Photograph(render, target, {}, &grad), Number("loss_photograph"), 2e-6);
  EXPECT_LE(ErrorOfGrad(Image("grad_loss_photograph")), 5e-5);
}

TEST_F(ObjectiveGoldenTest, ProposalsTakeTheShareOfLpipsFromL1) {
  Objective objective({}, [](auto&&...) { return 0.; });
  EXPECT_TRUE(objective.has_lpips());
  EXPECT_NEAR(objective.Proposal(render, target, confidence, &grad), Number("loss_proposal"), 2e-6);
  EXPECT_LE(ErrorOfGrad(Image("grad_loss_proposal")), 5e-5);
}

TEST_F(ObjectiveGoldenTest, L1GetsTheShareOfLpipsWithoutANetwork) {
  Objective objective({});
  EXPECT_FALSE(objective.has_lpips());
  EXPECT_NEAR(objective.Proposal(render, target, confidence, &grad),
              0.7 * Number("l1_weighted") + 0.3 * Number("dssim_weighted"), 2e-6);
  EXPECT_LE(ErrorOfGrad(0.7 * Image("grad_l1_weighted") + 0.3 * Image("grad_dssim_weighted")), 5e-5);
}

TEST_F(ObjectiveGoldenTest, WeighsLpipsByTheMeanConfidence) {
  const double mean = Wide(confidence).mean();
  const Eigen::ArrayXd difference = Wide(render) - Wide(target);
  const double square = difference.square().mean();
  Objective objective({}, MeanSquare);
  EXPECT_NEAR(objective.Proposal(render, target, confidence, &grad), Number("loss_proposal") + 0.3 * mean * square,
              2e-6);
  const Eigen::ArrayXd of_lpips = 0.3 * mean * 2 / static_cast<double>(render.count()) * difference;
  EXPECT_LE(ErrorOfGrad(Image("grad_loss_proposal") + of_lpips), 5e-5);

  Buffer<float> none;
  EXPECT_NEAR(objective.Proposal(render, target, {}, &none),
              0.4 * Number("l1") + 0.3 * (1 - Number("ssim")) + 0.3 * square, 2e-6);
}

TEST_F(ObjectiveGoldenTest, ScalesTheWholeLossOfProposals) {
  ObjectiveWeights weights;
  Objective one(weights, MeanSquare);
  Buffer<float> expected = Buffer<float>::Empty(render.shape());
  const double loss = one.Proposal(render, target, confidence, &expected);
  weights.proposal = 2.5;
  Objective more(weights, MeanSquare);
  EXPECT_NEAR(more.Proposal(render, target, confidence, &grad), 2.5 * loss, 1e-6);
  EXPECT_LE(ErrorOfGrad(2.5 * Wide(expected)), 1e-6);
  Buffer<float> none;
  EXPECT_EQ(more.Photograph(render, target, {}, &none), one.Photograph(render, target, {}, &none));
  weights.proposal = 0;
  EXPECT_EQ(Objective(weights, MeanSquare).Proposal(render, target, confidence, &grad), 0);
  EXPECT_EQ(MaxAbs(grad), 0);
}

TEST_F(ObjectiveGoldenTest, IgnoresProposalsWithoutConfidence) {
  bool asked = false;
  Objective objective({}, [&](auto&&...) {
    asked = true;
    return 1.;
  });
  EXPECT_EQ(objective.Proposal(render, target, Buffer<float>::Zeros(confidence.shape()), &grad), 0);
  EXPECT_EQ(MaxAbs(grad), 0);
  EXPECT_FALSE(asked);
}

TEST_F(ObjectiveGoldenTest, IgnoresMaskedPixels) {
  const Buffer<float> mask = Buffer<float>::Full(confidence.shape(), 1.f);
  Table(mask).middleCols(20, 10).setZero();
  const Buffer<float> other = render.Clone();
  Table(other).middleCols(60, 30).setConstant(9);
  Objective objective({});
  Buffer<float> expected = Buffer<float>::Empty(render.shape()), none;
  const double loss = objective.Photograph(render, target, mask, &expected);
  EXPECT_EQ(objective.Photograph(other, target, mask, &grad), loss);
  EXPECT_EQ(objective.Photograph(other, target, mask, &none), loss);
  EXPECT_TRUE(SameBytes(grad, expected));
  EXPECT_EQ(Table(grad).middleCols(60, 30).abs().maxCoeff(), 0);
  EXPECT_GT(Table(grad).leftCols(60).abs().maxCoeff(), 0);
}

TEST(Objective, RefusesShapesThatDoNotFit) {
  const Buffer<float> image = RandomUniform({8, 9, 3}, 1), mask = Buffer<float>::Full({8, 9}, 1.f);
  const Buffer<float> turned = Buffer<float>::Full({9, 8}, 1.f);
  Buffer<float> none;
  EXPECT_THROW(Objective({}).Photograph(image, image, turned, &none), ShapeError);
  EXPECT_THROW(Objective({}).Photograph(image, RandomUniform({9, 8, 3}, 1), mask, &none), ShapeError);
  EXPECT_THROW(Objective({}).Photograph(RandomUniform({8, 9}, 1), image, mask, &none), ShapeError);
  EXPECT_THROW(Objective({}).Proposal(image, image, turned, &none), ShapeError);
}

TEST(Objective, RefusesSharesOfMoreThanOne) {
  EXPECT_THAT(MessageOf<UsageError>([] {
                Objective({0.2, 0.75, 0.5, 1});
              }),
              testing::HasSubstr("--proposal-ssim 0.75 and --proposal-lpips 0.5 sum to 1.25"));
  EXPECT_NO_THROW(Objective({0.2, 0.7, 0.3, 1}));
}

}  // namespace
}  // namespace oraclegs
