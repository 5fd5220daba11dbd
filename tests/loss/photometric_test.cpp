#include "oraclegs/loss/photometric.h"

#include <gtest/gtest.h>

#include <cmath>

#include "loss/reference_ssim.h"
#include "support/tensors.h"

namespace oraclegs {
namespace {

struct Pair {
  Buffer<float> render, target, confidence;
};

Pair RandomPair(int64_t height, int64_t width, uint64_t seed) {
  torch::manual_seed(seed);
  const Buffer<float> target = torch::rand({height, width, 3});
  const Buffer<float> render = (target + 0.3 * torch::randn({height, width, 3}));
  return {render, target, torch::rand({height, width})};
}

TEST(PhotometricLoss, IdenticalPicturesCostNothing) {
  const Buffer<float> image = torch::rand({33, 29, 3});
  Buffer<float> grad = Buffer<float>::Full({33, 29, 3}, 7.f);
  const PhotometricValue value = PhotometricLoss()(image, image, {}, {}, &grad);
  EXPECT_EQ(value.l1, 0);
  EXPECT_NEAR(value.dssim, 0, 1e-6);
  EXPECT_LT(grad.abs().max().item<float>(), 1e-6f);
}

TEST(PhotometricLoss, FlatPicturesHaveTheClosedForm) {
  // In the interior of two constant pictures all variances vanish: S = (2ab + C1) / (a^2 + b^2 + C1).
  const float a = 0.6f, b = 0.2f;
  const Buffer<float> map = SsimMap(Buffer<float>::Full({31, 31, 3}, a), Buffer<float>::Full({31, 31, 3}, b));
  const double expected = (2 * a * b + 1e-4) / (a * a + b * b + 1e-4);
  EXPECT_NEAR(map[15][15][1].item<float>(), expected, 1e-4);
  const PhotometricValue value =
      PhotometricLoss()(Buffer<float>::Full({31, 31, 3}, a), Buffer<float>::Full({31, 31, 3}, b), {}, {1.f, 0.f}, nullptr);
  EXPECT_NEAR(value.l1, 0.4, 1e-6);
  EXPECT_EQ(value.loss, value.l1);
}

class PhotometricSizes : public testing::TestWithParam<std::pair<int64_t, int64_t>> {};

TEST_P(PhotometricSizes, MatchTheDefinition) {
  const auto [height, width] = GetParam();
  const Pair p = RandomPair(height, width, 11);
  const ReferencePhotometric expected = ReferenceLoss(p.render, p.target, p.confidence);
  const PhotometricValue value = PhotometricLoss()(p.render, p.target, p.confidence, {0.4f, 0.3f}, nullptr);
  EXPECT_NEAR(value.l1, expected.l1, 1e-6);
  EXPECT_NEAR(value.dssim, expected.dssim, 2e-6);
  EXPECT_NEAR(value.loss, 0.4 * expected.l1 + 0.3 * expected.dssim, 2e-6);
  EXPECT_LT(MaxAbsError(SsimMap(p.render, p.target), expected.ssim), 1e-4);
}

TEST_P(PhotometricSizes, GradientMatchesCentralDifferences) {
  const auto [height, width] = GetParam();
  const Pair p = RandomPair(height, width, 12);
  const PhotometricWeights weights{0.4f, 0.3f};
  Buffer<float> grad = torch::full({height, width, 3}, std::nanf(""));  // every entry must be written
  PhotometricLoss()(p.render, p.target, p.confidence, weights, &grad);
  ASSERT_TRUE(torch::isfinite(grad).all().item<bool>());

  const Buffer<float> direction = torch::randn({height, width, 3}, torch::kDouble);
  const auto loss_at = [&](double step) {
    const ReferencePhotometric r =
        ReferenceLoss(p.render.to(torch::kDouble) + step * direction, p.target, p.confidence);
    return static_cast<double>(weights.l1) * r.l1 + static_cast<double>(weights.dssim) * r.dssim;
  };
  const double numeric = (loss_at(1e-6) - loss_at(-1e-6)) / 2e-6;
  const double scale = (grad.to(torch::kDouble) * direction).norm().item<double>();
  EXPECT_NEAR((grad.to(torch::kDouble) * direction).sum().item<double>(), numeric, 2e-4 * std::max(scale, 1e-3));
}

// Smaller than the window, one pixel, exact and inexact multiples of vectors, several tiles both ways.
INSTANTIATE_TEST_SUITE_P(Sizes, PhotometricSizes,
                         testing::Values(std::pair{1, 1}, std::pair{5, 7}, std::pair{1, 40}, std::pair{40, 1},
                                         std::pair{16, 16}, std::pair{49, 31}, std::pair{100, 17}, std::pair{13, 261},
                                         std::pair{9, 530}));

TEST(PhotometricLoss, SinglePixelsOfTheGradientMatchCentralDifferences) {
  const Pair p = RandomPair(17, 23, 13);
  Buffer<float> grad = Buffer<float>::Empty(p.render.shape());
  PhotometricLoss()(p.render, p.target, p.confidence, {0.8f, 0.2f}, &grad);
  const Buffer<float> base = p.render.to(torch::kDouble);
  for (const auto& [y, x, c] : {std::array{0, 0, 0}, {16, 22, 2}, {8, 11, 1}, {0, 12, 2}, {15, 1, 0}}) {
    const auto loss_at = [&, y = y, x = x, c = c](double step) {
      Buffer<float> moved = base.Clone();
      moved[y][x][c] += step;
      const ReferencePhotometric r = ReferenceLoss(moved, p.target, p.confidence);
      return static_cast<double>(0.8f) * r.l1 + static_cast<double>(0.2f) * r.dssim;
    };
    const double numeric = (loss_at(1e-6) - loss_at(-1e-6)) / 2e-6;
    EXPECT_NEAR(grad[y][x][c].item<float>(), numeric, 1e-7) << y << " " << x << " " << c;
  }
}

TEST(PhotometricLoss, NoConfidenceMeansFullConfidence) {
  const Pair p = RandomPair(50, 70, 14);
  Buffer<float> without = Buffer<float>::Empty(p.render.shape()), with = Buffer<float>::Empty(p.render.shape());
  const PhotometricValue a = PhotometricLoss()(p.render, p.target, {}, {}, &without);
  const PhotometricValue b = PhotometricLoss()(p.render, p.target, Buffer<float>::Full({50, 70}, 1.f), {}, &with);
  EXPECT_EQ(a.loss, b.loss);
  EXPECT_TRUE(torch::equal(without, with));
}

TEST(PhotometricLoss, PixelsFarFromAllConfidenceGetNoGradient) {
  const Pair p = RandomPair(40, 60, 15);
  Buffer<float> confidence = Buffer<float>::Zeros({40, 60});
  confidence.slice(1, 0, 20).fill_(1);
  Buffer<float> grad = Buffer<float>::Empty(p.render.shape());
  const PhotometricValue value = PhotometricLoss()(p.render, p.target, confidence, {}, &grad);
  EXPECT_EQ(grad.slice(1, 25).abs().max().item<float>(), 0);  // the window reaches five pixels
  EXPECT_GT(grad.slice(1, 0, 20).abs().min().item<float>(), 0);

  Buffer<float> elsewhere = p.render.Clone();
  elsewhere.slice(1, 25).fill_(0.5);
  EXPECT_EQ(PhotometricLoss()(elsewhere, p.target, confidence, {}, nullptr).loss, value.loss);
}

TEST(PhotometricLoss, ValueDoesNotDependOnWhetherTheGradientIsAsked) {
  const Pair p = RandomPair(60, 45, 16);
  PhotometricLoss loss;
  Buffer<float> grad = Buffer<float>::Empty(p.render.shape()), none;
  const double with = loss(p.render, p.target, p.confidence, {}, &grad).loss;
  EXPECT_EQ(loss(p.render, p.target, p.confidence, {}, &none).loss, with);
  EXPECT_EQ(loss(p.render, p.target, p.confidence, {}, nullptr).loss, with);
}

TEST(PhotometricLoss, BrightRendersStayFinite) {
  // A raw render is not clamped: rounding must not turn a variance negative.
  const Buffer<float> render = Buffer<float>::Full({30, 30, 3}, 300.f) + 0.01 * torch::rand({30, 30, 3});
  Buffer<float> grad = torch::empty({30, 30, 3});
  const PhotometricValue value = PhotometricLoss()(render, torch::rand({30, 30, 3}), {}, {}, &grad);
  EXPECT_TRUE(std::isfinite(value.loss));
  EXPECT_TRUE(torch::isfinite(grad).all().item<bool>());
}

TEST(PhotometricLoss, RefusesTensorsThatDoNotFit) {
  const Buffer<float> image = torch::rand({8, 9, 3});
  PhotometricLoss loss;
  Buffer<float> small = torch::empty({8, 8, 3});
  EXPECT_THROW(loss(image, torch::rand({9, 8, 3}), {}, {}, nullptr), ShapeError);
  EXPECT_THROW(loss(torch::rand({3, 8, 9}), torch::rand({3, 8, 9}), {}, {}, nullptr), ShapeError);
  EXPECT_THROW(loss(image, image, torch::rand({8, 8}), {}, nullptr), ShapeError);
  EXPECT_THROW(loss(image, image, {}, {}, &small), ShapeError);
  EXPECT_THROW(loss(image.to(torch::kDouble), image, {}, {}, nullptr), ShapeError);
  EXPECT_THROW(loss(torch::empty({0, 4, 3}), torch::empty({0, 4, 3}), {}, {}, nullptr), ShapeError);
  EXPECT_THROW(SsimMap(image, torch::rand({8, 8, 3})), ShapeError);
}

}  // namespace
}  // namespace oraclegs
