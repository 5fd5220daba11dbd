#include "oraclegs/evaluate/metrics.h"

#include <ATen/Parallel.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "oraclegs/core/parallel.h"
#include "oraclegs/loss/photometric.h"
#include "support/tensors.h"

namespace oraclegs {
namespace {

Buffer<float> Interleaved(const Buffer<float>& planar) { return planar.permute({1, 2, 0}); }

TEST(MetricsGolden, PsnrAndSsimMatchTheReference) {
  const SafetensorsFile file = OpenGolden("ssim");
  const Buffer<float> render = Interleaved(GoldenFloat(file, "render")), target = Interleaved(GoldenFloat(file, "target"));
  EXPECT_NEAR(Psnr(render, target), GoldenTensor(file, "psnr").item<double>(), 2e-6);
  EXPECT_NEAR(Ssim(render, target), GoldenTensor(file, "ssim").item<double>(), 2e-6);
}

TEST(Psnr, HasTheClosedForm) {
  const Buffer<float> a = Buffer<float>::Full({4, 6, 3}, 0.5f), b = Buffer<float>::Full({4, 6, 3}, 0.6f);
  EXPECT_NEAR(Psnr(a, b), 20, 1e-5);
  EXPECT_TRUE(std::isinf(Psnr(a, a)) && Psnr(a, a) > 0);
}

TEST(Psnr, CountsOnlyTheMaskedPixels) {
  const Buffer<float> a = Buffer<float>::Zeros({4, 6, 3});
  Buffer<float> b = Buffer<float>::Zeros({4, 6, 3}), mask = torch::zeros({4, 6}, torch::kByte);
  b.slice(1, 0, 3).fill_(0.1f);
  b.slice(1, 3).fill_(1);
  mask.slice(1, 0, 3).fill_(1);
  EXPECT_NEAR(Psnr(a, b, mask), 20, 1e-5);
  EXPECT_NEAR(Psnr(a, b), -10 * std::log10((0.01 + 1) / 2), 1e-5);
  EXPECT_TRUE(std::isnan(Psnr(a, b, Buffer<float>::Zeros({4, 6}))));
}

TEST(Ssim, MasksAndIdenticalPictures) {
  torch::manual_seed(4);
  const Buffer<float> a = torch::rand({20, 30, 3}), b = torch::rand({20, 30, 3});
  EXPECT_NEAR(Ssim(a, a), 1, 1e-6);
  const Buffer<float> map = SsimMap(a, b).to(torch::kDouble);
  EXPECT_NEAR(Ssim(a, b), map.mean().item<double>(), 1e-9);
  EXPECT_NEAR(Ssim(a, b, Buffer<float>::Full({20, 30}, 1.f)), Ssim(a, b), 1e-12);
}

TEST(Ssim, WhatIsMaskedHasNoSayInTheWindowsOfItsNeighbours) {
  torch::manual_seed(4);
  const Buffer<float> truth = torch::rand({20, 30, 3}), mask = torch::zeros({20, 30}, torch::kByte);
  mask.slice(0, 5, 9).fill_(1);
  Buffer<float> render = truth.Clone();
  render.slice(0, 0, 5).fill_(1);
  render.slice(0, 9).fill_(0);
  EXPECT_NEAR(Ssim(render, truth, mask), 1, 1e-6);
  render.slice(0, 5, 9).mul_(0.5f);
  Buffer<float> only_the_counted = truth.Clone();
  only_the_counted.slice(0, 5, 9).mul_(0.5f);
  const Buffer<float> map = SsimMap(only_the_counted, truth).to(torch::kDouble);
  EXPECT_NEAR(Ssim(render, truth, mask), map.slice(0, 5, 9).mean().item<double>(), 1e-9);
}

TEST(Quantized, RoundsHalfUpAndClamps) {
  const Buffer<float> x = torch::tensor({-1.f, 0.f, 0.49f / 255, 0.51f / 255, 127.5f / 255, 1.f, 7.f});
  const Buffer<float> expected = torch::tensor({0.f, 0.f, 0.f, 1.f, 128.f, 255.f, 255.f}) / 255.f;
  EXPECT_TRUE(torch::equal(Quantized(x), expected));
  const Buffer<float> steps = torch::arange(256).to(torch::kFloat) / 255.f;
  EXPECT_TRUE(torch::equal(Quantized(steps), steps));
}

TEST(ColorCorrectedPsnr, UndoesAnAffineChangeOfColour) {
  torch::manual_seed(5);
  const Buffer<float> target = torch::rand({15, 16, 3});
  const Buffer<float> matrix = torch::tensor({{0.8f, 0.1f, 0.f}, {0.f, 0.7f, 0.1f}, {0.1f, 0.f, 0.9f}});
  const Buffer<float> render = (target.matmul(matrix) * 0.6f + 0.1f);
  EXPECT_LT(Psnr(render, target), 25);
  EXPECT_GT(ColorCorrectedPsnr(render, target), 100);
}

TEST(ColorCorrectedPsnr, IsNeverBelowPlainPsnr) {
  torch::manual_seed(6);
  const Buffer<float> target = torch::rand({15, 16, 3}), mask = (torch::rand({15, 16}) > 0.5).to(torch::kByte);
  const Buffer<float> render = (target + 0.2 * torch::randn({15, 16, 3})).clamp(0, 1);
  EXPECT_GE(ColorCorrectedPsnr(render, target), Psnr(render, target));
  EXPECT_GE(ColorCorrectedPsnr(render, target, mask), Psnr(render, target, mask));
}

TEST(ColorCorrectedPsnr, FlatPicturesAreNoTrouble) {
  const Buffer<float> flat = Buffer<float>::Full({6, 6, 3}, 0.25f);
  EXPECT_GT(ColorCorrectedPsnr(flat, Buffer<float>::Full({6, 6, 3}, 0.75f)), 100);
  EXPECT_GT(ColorCorrectedPsnr(Buffer<float>::Zeros({6, 6, 3}), Buffer<float>::Full({6, 6, 3}, 0.75f)), 100);
}

TEST(Metrics, HaveTheSameBitsForAnyNumberOfThreads) {
  torch::manual_seed(7);
  const Buffer<float> target = torch::rand({210, 330, 3}), mask = (torch::rand({210, 330}) > 0.3).to(torch::kByte);
  const Buffer<float> render = (target + 0.1 * torch::randn({210, 330, 3})).clamp(0, 1);
  const int torch_before = at::get_num_threads(), before = NumThreads();
  const auto scores = [&](int threads) {
    at::set_num_threads(threads);
    SetNumThreads(threads);
    return std::vector<double>{
        Psnr(render, target),       Psnr(render, target, mask),         Ssim(render, target),
        Ssim(render, target, mask), ColorCorrectedPsnr(render, target), ColorCorrectedPsnr(render, target, mask)};
  };
  const std::vector<double> one = scores(1), three = scores(3);
  at::set_num_threads(torch_before);
  SetNumThreads(before);
  EXPECT_EQ(one, three);
}

TEST(Metrics, RefuseTensorsThatDoNotFit) {
  const Buffer<float> a = torch::rand({4, 5, 3});
  EXPECT_THROW(Psnr(a, torch::rand({5, 4, 3})), ShapeError);
  EXPECT_THROW(Ssim(a, a, Buffer<float>::Full({5, 4}, 1.f)), ShapeError);
  EXPECT_THROW(ColorCorrectedPsnr(a.to(torch::kDouble), a), ShapeError);
}

}  // namespace
}  // namespace oraclegs
