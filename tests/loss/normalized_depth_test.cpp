#include "oraclegs/loss/depth_losses.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "oraclegs/core/parallel.h"
#include "support/buffers.h"
#include "support/finite_difference.h"

namespace oraclegs {
namespace {

constexpr auto kLocal = DepthNormalization::kLocal;
constexpr auto kGlobal = DepthNormalization::kGlobal;

double DeviationOf(const Eigen::ArrayXd& x) { return std::sqrt((x - x.mean()).square().sum() / (x.size() - 1)); }

/// The loss by its definition, without a mask. `whole`: deviation of the rendered image, which has no gradient.
struct Reference {
  int64_t height, width, side;
  DepthNormalization normalization;
  double tolerance;

  /// Numbers in the order of the patches.
  Eigen::ArrayXXd Patches(const Eigen::ArrayXd& image) const {
    const int64_t columns = width / side, rows = height / side;
    Eigen::ArrayXXd out(side * side, columns * rows);
    for (int64_t k = 0; k < columns * rows; ++k) {
      for (int64_t i = 0; i < side * side; ++i) {
        out(i, k) = image[(k / columns * side + i / side) * width + k % columns * side + i % side];
      }
    }
    return out;
  }
  Eigen::ArrayXXd Normalized(const Eigen::ArrayXd& image, double whole) const {
    const Eigen::ArrayXXd patches = Patches(image);
    const double all = DeviationOf(patches.reshaped());
    Eigen::ArrayXXd out = patches;
    for (int64_t k = 0; k < patches.cols(); ++k) {
      const double deviation = normalization == kLocal ? DeviationOf(patches.col(k)) : whole;
      out.col(k) = (patches.col(k) - patches.col(k).mean()) / (deviation + 0.01 * all);
    }
    return out;
  }
  double Loss(const Eigen::ArrayXd& rendered, const Eigen::ArrayXd& target, double whole) const {
    const Eigen::ArrayXXd d = Normalized(rendered, whole) - Normalized(target, DeviationOf(target));
    const auto in = (d.abs() > tolerance).cast<double>();
    return (d.square() * in).sum() / in.sum();
  }
};

void ExpectReference(DepthNormalization normalization, double tolerance) {
  const Reference reference{23, 31, 7, normalization, tolerance};
  const DepthImages images{RandomUniform({23, 31}, 1), RandomUniform({23, 31}, 2), {}};
  Buffer<float> grad = Buffer<float>::Full({23, 31}, 9.f);
  const double value = NormalizedDepthLoss(images, {normalization, 7, tolerance}, 0.3, &grad);
  const Eigen::ArrayXd wide = Wide(images.rendered), target = Wide(images.target);
  std::vector<double> rendered(wide.begin(), wide.end());
  const double whole = DeviationOf(wide);
  const auto loss = [&] {
    return 0.3 * reference.Loss(Eigen::Map<Eigen::ArrayXd>(rendered.data(), wide.size()), target, whole);
  };
  EXPECT_NEAR(value, loss(), 1e-9);
  ExpectCentralDifferences("rendered", loss, rendered, grad, 3);
  EXPECT_EQ(grad[22 * 31 + 5], 0);  // below the last whole patch
  EXPECT_EQ(grad[5 * 31 + 30], 0);  // beside it
}

TEST(NormalizedDepthLoss, LocalMatchesItsDefinitionAndCentralDifferences) {
  ExpectReference(kLocal, 0.00025);
  ExpectReference(kLocal, 0.5);
}

TEST(NormalizedDepthLoss, GlobalMatchesItsDefinitionAndCentralDifferences) {
  ExpectReference(kGlobal, 0.00025);
  ExpectReference(kGlobal, 0.5);
}

TEST(NormalizedDepthLoss, IgnoresScaleAndOffset) {
  const Buffer<float> target = RandomUniform({16, 16}, 1), same = ToBuffer({16, 16}, 3 * Wide(target) + 2);
  for (const auto normalization : {kLocal, kGlobal}) {
    Buffer<float> grad = Buffer<float>::Full({16, 16}, 9.f);
    EXPECT_EQ(NormalizedDepthLoss({same, target, {}}, {normalization, 8, 0.00025}, 1, &grad), 0);
    EXPECT_EQ(MaxAbs(grad), 0);
  }
}

TEST(NormalizedDepthLoss, LocalIgnoresTheScaleOfEachPatch) {
  const Buffer<float> target = RandomUniform({8, 16}, 1), other = target.Clone();
  for (int64_t y = 0; y < 8; ++y) {
    for (int64_t x = 8; x < 16; ++x) other[y * 16 + x] = 1 + 1.1f * other[y * 16 + x];
  }
  EXPECT_EQ(NormalizedDepthLoss({other, target, {}}, {kLocal, 8, 0.03}, 1, nullptr), 0);  // smoothing: 1%
  EXPECT_GT(NormalizedDepthLoss({other, target, {}}, {kGlobal, 8, 0.03}, 1, nullptr), 0.001);
}

TEST(NormalizedDepthLoss, MaskedGradientMatchesCentralDifferences) {
  DepthImages images{RandomUniform({12, 18}, 1), RandomUniform({12, 18}, 2), RandomUniform({12, 18}, 3)};
  const NormalizedDepthOptions options{kLocal, 6, 0};
  Buffer<float> grad = Buffer<float>::Empty({12, 18});
  NormalizedDepthLoss(images, options, 1, &grad);
  for (int64_t pixel = 0; pixel < 12 * 18; pixel += 5) {
    const float keep = images.rendered[pixel];
    images.rendered[pixel] = keep + 1e-3f;
    const double above = NormalizedDepthLoss(images, options, 1, nullptr);
    images.rendered[pixel] = keep - 1e-3f;
    const double below = NormalizedDepthLoss(images, options, 1, nullptr);
    images.rendered[pixel] = keep;
    EXPECT_NEAR(grad[pixel], (above - below) / 2e-3, 2e-3 * MaxAbs(grad)) << pixel;
  }
}

TEST(NormalizedDepthLoss, IgnoresMaskedPixels) {
  DepthImages images{RandomUniform({12, 18}, 1), RandomUniform({12, 18}, 2), Above(RandomUniform({12, 18}, 3), 0.5f)};
  for (int64_t y = 0; y < 6; ++y) {
    for (int64_t x = 0; x < 6; ++x) images.mask[y * 18 + x] = y + x == 0 ? 1.f : 0.f;  // a patch of one pixel
  }
  Buffer<float> grad = Buffer<float>::Empty({12, 18}), again = grad.Clone();
  const double value = NormalizedDepthLoss(images, {kLocal, 6, 0}, 1, &grad);
  EXPECT_EQ(grad[0], 0);
  for (int64_t i = 0; i < 12 * 18; ++i) {
    if (images.mask[i] == 0) images.rendered[i] = images.target[i] = std::nanf("");
  }
  EXPECT_EQ(NormalizedDepthLoss(images, {kLocal, 6, 0}, 1, &again), value);
  EXPECT_TRUE(SameBytes(grad, again));
}

TEST(NormalizedDepthLoss, IsNothingForConstantImages) {
  const Buffer<float> flat = Buffer<float>::Full({8, 8}, 0.3f), varied = RandomUniform({8, 8}, 1);
  for (const auto normalization : {kLocal, kGlobal}) {
    for (const DepthImages& images : {DepthImages{flat, varied, {}}, DepthImages{varied, flat, {}}}) {
      Buffer<float> grad = Buffer<float>::Full({8, 8}, 9.f);
      EXPECT_EQ(NormalizedDepthLoss(images, {normalization, 4, 0}, 1, &grad), 0);
      EXPECT_EQ(MaxAbs(grad), 0);
    }
  }
}

TEST(NormalizedDepthLoss, GivesTheSameBitsForAnyNumberOfThreads) {
  const DepthImages images{RandomUniform({100, 90}, 1), RandomUniform({100, 90}, 2), RandomUniform({100, 90}, 3)};
  Buffer<float> one = Buffer<float>::Empty({100, 90}), three = Buffer<float>::Empty({100, 90});
  SetNumThreads(1);
  const double value = NormalizedDepthLoss(images, {kGlobal, 8, 0.001}, 1, &one);
  SetNumThreads(3);
  EXPECT_EQ(NormalizedDepthLoss(images, {kGlobal, 8, 0.001}, 1, &three), value);
  SetNumThreads(0);
  EXPECT_TRUE(SameBytes(one, three));
}

TEST(DrawPatchSide, IsUniformOverTheRange) {
  std::set<int64_t> drawn;
  int different = 0;
  for (int64_t iteration = 0; iteration < 400; ++iteration) {
    const int64_t side = DrawPatchSide({5, 17}, kLocal, 1, iteration);
    EXPECT_EQ(side, DrawPatchSide({5, 17}, kLocal, 1, iteration));
    different += side != DrawPatchSide({5, 17}, kGlobal, 1, iteration);
    drawn.insert(side);
  }
  EXPECT_EQ(drawn.size(), 13U);
  EXPECT_EQ(*drawn.begin(), 5);
  EXPECT_EQ(*drawn.rbegin(), 17);
  EXPECT_GT(different, 300);
}

TEST(NormalizedDepthLoss, RefusesShapesThatDoNotFit) {
  const Buffer<float> a = RandomUniform({3, 4}, 1), b = RandomUniform({4, 3}, 2);
  EXPECT_THROW(NormalizedDepthLoss({a, b, {}}, {}, 1, nullptr), ShapeError);
  EXPECT_THROW(NormalizedDepthLoss({a, a, {}}, {kLocal, 0, 0}, 1, nullptr), ShapeError);
}

}  // namespace
}  // namespace oraclegs
