#include "oraclegs/loss/photometric.h"

#include <gtest/gtest.h>

#include <cmath>

#include "loss/reference_ssim.h"
#include "support/buffers.h"

namespace oraclegs {
namespace {

struct Pair {
  Buffer<float> render, target, confidence;
};

Pair RandomPair(int64_t height, int64_t width, uint32_t seed) {
  const Shape shape{height, width, 3};
  const Buffer<float> target = RandomUniform(shape, seed), noise = RandomNormal(shape, seed + 1000);
  return {ToBuffer(shape, Flat(target) + 0.3f * Flat(noise)), target, RandomUniform({height, width}, seed + 2000)};
}

/// The image moved from `base` along `direction`.
Buffer<double> Moved(const Buffer<float>& base, const Eigen::ArrayXd& direction, double step) {
  const Buffer<double> moved = Buffer<double>::Empty(base.shape());
  Flat(moved) = Wide(base) + step * direction;
  return moved;
}

TEST(PhotometricLoss, IsZeroForIdenticalImages) {
  const Buffer<float> image = RandomUniform({33, 29, 3}, 1);
  Buffer<float> grad = Buffer<float>::Full({33, 29, 3}, 7.f);
  const PhotometricValue value = PhotometricLoss()(image, image, {}, {}, &grad);
  EXPECT_EQ(value.l1, 0);
  EXPECT_NEAR(value.dssim, 0, 1e-6);
  EXPECT_LT(MaxAbs(grad), 1e-6);
}

TEST(PhotometricLoss, HasTheClosedFormForFlatImages) {
  // In the interior of two constant images all variances vanish: S = (2ab + C1) / (a^2 + b^2 + C1).
  const float a = 0.6f, b = 0.2f;
  const Buffer<float> flat_a = Buffer<float>::Full({31, 31, 3}, a), flat_b = Buffer<float>::Full({31, 31, 3}, b);
  const Buffer<float> map = SsimMap(flat_a, flat_b);
  const double expected = (2 * a * b + 1e-4) / (a * a + b * b + 1e-4);
  EXPECT_NEAR(map[(15 * 31 + 15) * 3 + 1], expected, 1e-4);
  const PhotometricValue value = PhotometricLoss()(flat_a, flat_b, {}, {1.f, 0.f}, nullptr);
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
  Buffer<float> grad = Buffer<float>::Full({height, width, 3}, std::nanf(""));  // every entry must be written
  PhotometricLoss()(p.render, p.target, p.confidence, weights, &grad);
  ASSERT_TRUE(AllFinite(grad));

  const Eigen::ArrayXd direction = Wide(RandomNormal({height, width, 3}, 99));
  const auto loss_at = [&](double step) {
    const ReferencePhotometric r = ReferenceLoss(Moved(p.render, direction, step), p.target, p.confidence);
    return static_cast<double>(weights.l1) * r.l1 + static_cast<double>(weights.dssim) * r.dssim;
  };
  const double numeric = (loss_at(1e-6) - loss_at(-1e-6)) / 2e-6;
  const Eigen::ArrayXd product = Wide(grad) * direction;
  EXPECT_NEAR(product.sum(), numeric, 2e-4 * std::max(product.matrix().norm(), 1e-3));
}

// Smaller than the window, one pixel, exact and inexact multiples of vectors, several tiles both ways.
INSTANTIATE_TEST_SUITE_P(Sizes, PhotometricSizes,
                         testing::Values(std::pair{1, 1}, std::pair{5, 7}, std::pair{1, 40}, std::pair{40, 1},
                                         std::pair{16, 16}, std::pair{49, 31}, std::pair{100, 17}, std::pair{13, 261},
                                         std::pair{9, 530}));

TEST(PhotometricLoss, GradientOfSinglePixelsMatchesCentralDifferences) {
  const Pair p = RandomPair(17, 23, 13);
  Buffer<float> grad = Buffer<float>::Empty(p.render.shape());
  PhotometricLoss()(p.render, p.target, p.confidence, {0.8f, 0.2f}, &grad);
  for (const auto& [y, x, c] : {std::array{0, 0, 0}, {16, 22, 2}, {8, 11, 1}, {0, 12, 2}, {15, 1, 0}}) {
    const int64_t at = (y * 23 + x) * 3 + c;
    Eigen::ArrayXd direction = Eigen::ArrayXd::Zero(p.render.count());
    direction[at] = 1;
    const auto loss_at = [&](double step) {
      const ReferencePhotometric r = ReferenceLoss(Moved(p.render, direction, step), p.target, p.confidence);
      return static_cast<double>(0.8f) * r.l1 + static_cast<double>(0.2f) * r.dssim;
    };
    const double numeric = (loss_at(1e-6) - loss_at(-1e-6)) / 2e-6;
    EXPECT_NEAR(grad[at], numeric, 1e-7) << y << " " << x << " " << c;
  }
}

TEST(PhotometricLoss, TakesNoConfidenceForFullConfidence) {
  const Pair p = RandomPair(50, 70, 14);
  Buffer<float> without = Buffer<float>::Empty(p.render.shape()), with = Buffer<float>::Empty(p.render.shape());
  const PhotometricValue a = PhotometricLoss()(p.render, p.target, {}, {}, &without);
  const PhotometricValue b = PhotometricLoss()(p.render, p.target, Buffer<float>::Full({50, 70}, 1.f), {}, &with);
  EXPECT_EQ(a.loss, b.loss);
  EXPECT_TRUE(SameBytes(without, with));
}

TEST(PhotometricLoss, GivesNoGradientFarFromAllConfidence) {
  const Pair p = RandomPair(40, 60, 15);
  const Buffer<float> confidence = Buffer<float>::Zeros({40, 60});
  Table(confidence).leftCols(20).setOnes();
  Buffer<float> grad = Buffer<float>::Empty(p.render.shape());
  const PhotometricValue value = PhotometricLoss()(p.render, p.target, confidence, {}, &grad);
  EXPECT_EQ(Table(grad).rightCols(3 * 35).abs().maxCoeff(), 0);  // the window reaches five pixels
  EXPECT_GT(Table(grad).leftCols(3 * 20).abs().minCoeff(), 0);

  const Buffer<float> elsewhere = p.render.Clone();
  Table(elsewhere).rightCols(3 * 35).setConstant(0.5f);
  EXPECT_EQ(PhotometricLoss()(elsewhere, p.target, confidence, {}, nullptr).loss, value.loss);
}

TEST(PhotometricLoss, IgnoresMaskedPixels) {
  const Pair p = RandomPair(32, 48, 17);
  const Buffer<float> mask = Buffer<float>::Full({32, 48}, 1.f);
  Table(mask).middleCols(20, 10).setZero();
  const PixelWeights pixels{mask, MaskMeaning::kMask};
  const Buffer<float> other = p.render.Clone();
  Table(other).middleCols(60, 30).setConstant(9);
  PhotometricLoss loss;
  Buffer<float> grad = Buffer<float>::Empty(other.shape()), expected = Buffer<float>::Empty(other.shape());
  const double value = loss(p.render, p.target, pixels, {}, &expected).loss;
  EXPECT_EQ(loss(other, p.target, pixels, {}, &grad).loss, value);
  EXPECT_EQ(loss(other, p.target, pixels, {}, nullptr).loss, value);
  EXPECT_TRUE(SameBytes(grad, expected));
  EXPECT_EQ(Table(grad).middleCols(60, 30).abs().maxCoeff(), 0);
  EXPECT_GT(Table(grad).leftCols(60).abs().maxCoeff(), 0);
  EXPECT_NE(loss(other, p.target, mask, {}, nullptr).loss, value);  // a confidence: windows see the render
}

TEST(PhotometricLoss, HasTheSameValueWithoutGradient) {
  const Pair p = RandomPair(60, 45, 16);
  PhotometricLoss loss;
  Buffer<float> grad = Buffer<float>::Empty(p.render.shape()), none;
  const double with = loss(p.render, p.target, p.confidence, {}, &grad).loss;
  EXPECT_EQ(loss(p.render, p.target, p.confidence, {}, &none).loss, with);
  EXPECT_EQ(loss(p.render, p.target, p.confidence, {}, nullptr).loss, with);
}

TEST(PhotometricLoss, StaysFiniteForBrightRenders) {
  // A raw render is not clamped: rounding must not turn a variance negative.
  const Buffer<float> render = RandomUniform({30, 30, 3}, 1);
  Flat(render) = 300 + 0.01f * Flat(render);
  Buffer<float> grad = Buffer<float>::Empty({30, 30, 3});
  const PhotometricValue value = PhotometricLoss()(render, RandomUniform({30, 30, 3}, 2), {}, {}, &grad);
  EXPECT_TRUE(std::isfinite(value.loss));
  EXPECT_TRUE(AllFinite(grad));
}

TEST(PhotometricLoss, RefusesShapesThatDoNotFit) {
  const Buffer<float> image = RandomUniform({8, 9, 3}, 1), empty = Buffer<float>::Empty({0, 4, 3});
  PhotometricLoss loss;
  Buffer<float> small = Buffer<float>::Empty({8, 8, 3});
  EXPECT_THROW(loss(image, RandomUniform({9, 8, 3}, 1), {}, {}, nullptr), ShapeError);
  EXPECT_THROW(loss(RandomUniform({3, 8, 9}, 1), RandomUniform({3, 8, 9}, 2), {}, {}, nullptr), ShapeError);
  EXPECT_THROW(loss(image, image, RandomUniform({8, 8}, 1), {}, nullptr), ShapeError);
  EXPECT_THROW(loss(image, image, {Buffer<float>::Full({9, 8}, 1.f), MaskMeaning::kMask}, {}, nullptr), ShapeError);
  EXPECT_THROW(loss(image, image, {}, {}, &small), ShapeError);
  EXPECT_THROW(loss({}, image, {}, {}, nullptr), ShapeError);
  EXPECT_THROW(loss(empty, empty, {}, {}, nullptr), ShapeError);
  EXPECT_THROW(SsimMap(image, RandomUniform({8, 8, 3}, 1)), ShapeError);
}

}  // namespace
}  // namespace oraclegs
