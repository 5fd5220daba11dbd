#include "oraclegs/loss/depth_losses.h"

#include <gtest/gtest.h>

#include <cmath>

#include "oraclegs/core/parallel.h"
#include "support/buffers.h"
#include "support/finite_difference.h"

namespace oraclegs {
namespace {

/// 1 - r by its definition, over the flat numbers of a patch.
double OneMinusCorrelation(const Eigen::ArrayXd& a, const Eigen::ArrayXd& b, const Eigen::ArrayXd& w) {
  const Eigen::ArrayXd da = a - (w * a).sum() / w.sum(), db = b - (w * b).sum() / w.sum();
  return 1 - (w * da * db).sum() / std::sqrt((w * da * da).sum() * (w * db * db).sum());
}

/// Numbers of a patch, row after row.
Eigen::ArrayXd Cut(const Eigen::ArrayXd& image, int64_t width, const ImagePatch& p) {
  Eigen::ArrayXd out(p.width * p.height);
  for (int64_t i = 0; i < out.size(); ++i) out[i] = image[(p.y + i / p.width) * width + p.x + i % p.width];
  return out;
}

DepthImages RandomDepths(int64_t height, int64_t width) {
  return {RandomUniform({height, width}, 1), RandomUniform({height, width}, 2), RandomUniform({height, width}, 3)};
}

TEST(PearsonDepthLoss, IgnoresScaleAndOffset) {
  const Buffer<float> target = RandomUniform({9, 7}, 1);
  const Buffer<float> up = ToBuffer({9, 7}, 0.3 * Wide(target) + 2), down = ToBuffer({9, 7}, 5 - 2 * Wide(target));
  Buffer<float> grad = Buffer<float>::Full({9, 7}, 9.f);
  EXPECT_NEAR(PearsonDepthLoss({up, target, {}}, 0.5, &grad), 0, 1e-9);
  EXPECT_LT(MaxAbs(grad), 1e-5);
  EXPECT_NEAR(PearsonDepthLoss({down, target, {}}, 0.5, nullptr), 1, 1e-9);
}

TEST(PearsonDepthLoss, MatchesItsDefinitionAndCentralDifferences) {
  const DepthImages images = RandomDepths(37, 23);  // several blocks of rows and a remainder
  Buffer<float> grad = Buffer<float>::Full({37, 23}, 9.f);
  const double value = PearsonDepthLoss(images, 0.7, &grad);
  const Eigen::ArrayXd wide = Wide(images.rendered);
  std::vector<double> rendered(wide.begin(), wide.end());
  const auto loss = [&] {
    return 0.7 * OneMinusCorrelation(Eigen::Map<Eigen::ArrayXd>(rendered.data(), wide.size()), Wide(images.target),
                                     Wide(images.mask));
  };
  EXPECT_NEAR(value, loss(), 1e-12);
  ExpectCentralDifferences("rendered", loss, rendered, grad, 7);
}

TEST(PearsonDepthLoss, IgnoresMaskedPixels) {
  DepthImages images = RandomDepths(8, 8);
  images.mask = Above(images.mask, 0.5f);
  Buffer<float> grad = Buffer<float>::Empty({8, 8});
  const double value = PearsonDepthLoss(images, 1, &grad);
  const Buffer<float> before = grad.Clone();
  for (int64_t i = 0; i < 64; ++i) {
    if (images.mask[i] == 0) images.rendered[i] = images.target[i] = std::nanf("");
  }
  EXPECT_EQ(PearsonDepthLoss(images, 1, &grad), value);
  EXPECT_TRUE(SameBytes(grad, before));
  for (int64_t i = 0; i < 64; ++i) EXPECT_EQ(grad[i] == 0, images.mask[i] == 0);
}

TEST(PearsonDepthLoss, IsNothingWithoutACorrelation) {
  const Buffer<float> varied = RandomUniform({5, 6}, 1), flat = Buffer<float>::Full({5, 6}, 0.3f);
  const Buffer<float> single = Buffer<float>::Zeros({5, 6}), none = Buffer<float>::Zeros({5, 6});
  single[7] = 1;
  for (const DepthImages& images : {DepthImages{varied, flat, {}}, DepthImages{flat, varied, {}},
                                    DepthImages{varied, varied, single}, DepthImages{varied, varied, none}}) {
    Buffer<float> grad = Buffer<float>::Full({5, 6}, 9.f);
    EXPECT_EQ(PearsonDepthLoss(images, 1, &grad), 0);
    EXPECT_EQ(MaxAbs(grad), 0);
  }
}

TEST(PatchPearsonDepthLoss, MatchesItsDefinitionAndCentralDifferences) {
  const DepthImages images = RandomDepths(30, 40);
  const std::vector<ImagePatch> patches = {{0, 0, 9, 8}, {5, 4, 20, 18}, {31, 22, 9, 8}};  // two overlap
  Buffer<float> grad = Buffer<float>::Empty({30, 40});
  const double value = PatchPearsonDepthLoss(images, patches, 0.15, &grad);
  const Eigen::ArrayXd wide = Wide(images.rendered);
  std::vector<double> rendered(wide.begin(), wide.end());
  const auto loss = [&] {
    double sum = 0;
    for (const ImagePatch& p : patches) {
      sum += OneMinusCorrelation(Cut(Eigen::Map<Eigen::ArrayXd>(rendered.data(), wide.size()), 40, p),
                                 Cut(Wide(images.target), 40, p), Cut(Wide(images.mask), 40, p));
    }
    return 0.15 * sum / 3;
  };
  EXPECT_NEAR(value, loss(), 1e-12);
  ExpectCentralDifferences("rendered", loss, rendered, grad, 3);
}

TEST(PatchPearsonDepthLoss, AveragesOverPatchesThatHaveACorrelation) {
  DepthImages images = RandomDepths(8, 20);
  const ImagePatch left{0, 0, 8, 8}, right{12, 0, 8, 8};
  const double value = PatchPearsonDepthLoss(images, {left}, 1, nullptr);
  for (int64_t y = 0; y < 8; ++y) {
    for (int64_t x = 12; x < 20; ++x) images.mask[y * 20 + x] = 0;
  }
  EXPECT_EQ(PatchPearsonDepthLoss(images, {left, right}, 1, nullptr), value);
  EXPECT_EQ(PatchPearsonDepthLoss(images, {}, 1, nullptr), 0);
}

TEST(PearsonDepthLoss, GivesTheSameBitsForAnyNumberOfThreads) {
  const DepthImages images = RandomDepths(200, 100);
  Buffer<float> one = Buffer<float>::Empty({200, 100}), three = Buffer<float>::Empty({200, 100});
  SetNumThreads(1);
  const double value = PearsonDepthLoss(images, 1, &one);
  SetNumThreads(3);
  EXPECT_EQ(PearsonDepthLoss(images, 1, &three), value);
  SetNumThreads(0);
  EXPECT_TRUE(SameBytes(one, three));
}

TEST(PearsonDepthLoss, RefusesShapesThatDoNotFit) {
  const Buffer<float> a = RandomUniform({3, 4}, 1), b = RandomUniform({4, 3}, 2), empty = Buffer<float>::Empty({0, 4});
  Buffer<float> grad = Buffer<float>::Empty({4, 3});
  EXPECT_THROW(PearsonDepthLoss({a, b, {}}, 1, nullptr), ShapeError);
  EXPECT_THROW(PearsonDepthLoss({a, a, b}, 1, nullptr), ShapeError);
  EXPECT_THROW(PearsonDepthLoss({a, a, {}}, 1, &grad), ShapeError);
  EXPECT_THROW(PearsonDepthLoss({empty, empty, {}}, 1, nullptr), ShapeError);
  EXPECT_THROW(PatchPearsonDepthLoss({a, a, {}}, {{2, 0, 3, 3}}, 1, nullptr), ShapeError);
}

}  // namespace
}  // namespace oraclegs
