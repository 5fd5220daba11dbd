#include "oraclegs/evaluate/metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "oraclegs/core/parallel.h"
#include "oraclegs/loss/photometric.h"
#include "support/buffers.h"

namespace oraclegs {
namespace {

/// [H,W,3] from [3,H,W].
Buffer<float> Interleaved(const Buffer<float>& planar) {
  const int64_t pixels = planar.size(1) * planar.size(2);
  const auto image = Buffer<float>::Empty({planar.size(1), planar.size(2), 3});
  for (int64_t i = 0; i < 3 * pixels; ++i) image[i] = planar[(i % 3) * pixels + i / 3];
  return image;
}

double GoldenNumber(const SafetensorsFile& file, const std::string& name) { return file.Values<double>(name).at(0); }

/// Uniform noise in [0, 1).
Buffer<float> Noise(const Shape& shape, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> draw;
  const auto buffer = Buffer<float>::Empty(shape);
  for (float& value : buffer.span()) value = draw(random);
  return buffer;
}

/// Replaces each number x by change(x).
template <class Change>
Buffer<float> Changed(const Buffer<float>& buffer, const Change& change) {
  const Buffer<float> changed = buffer.Clone();
  std::transform(buffer.span().begin(), buffer.span().end(), changed.data(), change);
  return changed;
}

Buffer<float> Clamped(const Buffer<float>& buffer) {
  return Changed(buffer, [](float x) { return std::clamp(x, 0.f, 1.f); });
}

/// The image with noise of this standard deviation.
Buffer<float> Noisy(const Buffer<float>& image, float deviation, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<float> draw(0, deviation);
  return Clamped(Changed(image, [&](float x) { return x + draw(random); }));
}

/// 1 where the noise exceeds the threshold.
Buffer<float> RandomMask(const Shape& shape, float threshold, uint64_t seed) {
  return Changed(Noise(shape, seed), [&](float x) { return x > threshold ? 1.f : 0.f; });
}

void Fill(const Buffer<float>& rows, float value) { std::fill_n(rows.data(), rows.count(), value); }

double Mean(const Buffer<float>& buffer) {
  double sum = 0;
  for (const float value : buffer.span()) sum += static_cast<double>(value);
  return sum / static_cast<double>(buffer.count());
}

TEST(MetricsGolden, PsnrAndSsimMatchTheReference) {
  const SafetensorsFile file = OpenGolden("ssim");
  const Buffer<float> render = Interleaved(GoldenFloat(file, "render")),
                      target = Interleaved(GoldenFloat(file, "target"));
  EXPECT_NEAR(Psnr(render, target), GoldenNumber(file, "psnr"), 2e-6);
  EXPECT_NEAR(Ssim(render, target), GoldenNumber(file, "ssim"), 2e-6);
}

TEST(Psnr, HasTheClosedForm) {
  const auto a = Buffer<float>::Full({4, 6, 3}, 0.5f), b = Buffer<float>::Full({4, 6, 3}, 0.6f);
  EXPECT_NEAR(Psnr(a, b), 20, 1e-5);
  EXPECT_TRUE(std::isinf(Psnr(a, a)) && Psnr(a, a) > 0);
}

TEST(Psnr, IgnoresMaskedPixels) {
  const auto a = Buffer<float>::Zeros({4, 6, 3}), b = Buffer<float>::Zeros({4, 6, 3}),
             mask = Buffer<float>::Zeros({4, 6});
  Fill(b.Rows(0, 2), 0.1f);
  Fill(b.Rows(2, 4), 1);
  Fill(mask.Rows(0, 2), 1);
  EXPECT_NEAR(Psnr(a, b, mask), 20, 1e-5);
  EXPECT_NEAR(Psnr(a, b), -10 * std::log10((0.01 + 1) / 2), 1e-5);
  EXPECT_TRUE(std::isnan(Psnr(a, b, Buffer<float>::Zeros({4, 6}))));
}

TEST(Ssim, IsOneForIdenticalImagesAndTheMeanOfItsMap) {
  const Buffer<float> a = Noise({20, 30, 3}, 4), b = Noise({20, 30, 3}, 5);
  EXPECT_NEAR(Ssim(a, a), 1, 1e-6);
  EXPECT_NEAR(Ssim(a, b), Mean(SsimMap(a, b)), 1e-9);
  EXPECT_NEAR(Ssim(a, b, Buffer<float>::Full({20, 30}, 1.f)), Ssim(a, b), 1e-12);
}

TEST(Ssim, IgnoresMaskedPixelsInTheWindowsOfTheirNeighbors) {
  const Buffer<float> truth = Noise({20, 30, 3}, 4), mask = Buffer<float>::Zeros({20, 30});
  Fill(mask.Rows(5, 9), 1);
  const Buffer<float> render = truth.Clone();
  Fill(render.Rows(0, 5), 1);
  Fill(render.Rows(9, 20), 0);
  EXPECT_NEAR(Ssim(render, truth, mask), 1, 1e-6);
  const Buffer<float> only_the_counted = truth.Clone();
  for (const Buffer<float>& image : {render, only_the_counted}) {
    for (float& value : image.Rows(5, 9).span()) value *= 0.5f;
  }
  EXPECT_NEAR(Ssim(render, truth, mask), Mean(SsimMap(only_the_counted, truth).Rows(5, 9)), 1e-9);
}

TEST(Quantized, RoundsHalfUpAndClamps) {
  const auto x = Buffer<float>::From({7}, {-1.f, 0.f, 0.49f / 255, 0.51f / 255, 127.5f / 255, 1.f, 7.f});
  const std::vector<float> bytes = {0.f, 0.f, 0.f, 1.f, 128.f, 255.f, 255.f};
  for (size_t i = 0; i < bytes.size(); ++i) EXPECT_EQ(Quantized(x)[static_cast<int64_t>(i)], bytes[i] / 255.f) << i;
  const auto steps = Buffer<float>::Empty({256});
  for (int i = 0; i < 256; ++i) steps[i] = static_cast<float>(i) / 255.f;
  EXPECT_EQ(MaxAbsError(Quantized(steps), steps), 0);
}

TEST(ColorCorrectedPsnr, UndoesAnAffineChangeOfColor) {
  const Buffer<float> target = Noise({15, 16, 3}, 5), render = target.Clone();
  const float matrix[3][3] = {{0.8f, 0.1f, 0.f}, {0.f, 0.7f, 0.1f}, {0.1f, 0.f, 0.9f}};
  for (int64_t i = 0; i < render.count(); ++i) {
    const int64_t pixel = i - i % 3;
    float sum = 0;
    for (int64_t c = 0; c < 3; ++c) sum += target[pixel + c] * matrix[c][i % 3];
    render[i] = sum * 0.6f + 0.1f;
  }
  EXPECT_LT(Psnr(render, target), 25);
  EXPECT_GT(ColorCorrectedPsnr(render, target), 100);
}

TEST(ColorCorrectedPsnr, IsNeverBelowPlainPsnr) {
  const Buffer<float> target = Noise({15, 16, 3}, 6), mask = RandomMask({15, 16}, 0.5f, 7);
  const Buffer<float> render = Noisy(target, 0.2f, 8);
  EXPECT_GE(ColorCorrectedPsnr(render, target), Psnr(render, target));
  EXPECT_GE(ColorCorrectedPsnr(render, target, mask), Psnr(render, target, mask));
}

TEST(ColorCorrectedPsnr, SolvesFlatImages) {
  const auto flat = Buffer<float>::Full({6, 6, 3}, 0.25f);
  EXPECT_GT(ColorCorrectedPsnr(flat, Buffer<float>::Full({6, 6, 3}, 0.75f)), 100);
  EXPECT_GT(ColorCorrectedPsnr(Buffer<float>::Zeros({6, 6, 3}), Buffer<float>::Full({6, 6, 3}, 0.75f)), 100);
}

TEST(Metrics, HaveTheSameBitsForAnyNumberOfThreads) {
  const Buffer<float> target = Noise({210, 330, 3}, 7), mask = RandomMask({210, 330}, 0.3f, 8);
  const Buffer<float> render = Noisy(target, 0.1f, 9);
  const int before = NumThreads();
  const auto scores = [&](int threads) {
    SetNumThreads(threads);
    return std::vector<double>{
        Psnr(render, target),       Psnr(render, target, mask),         Ssim(render, target),
        Ssim(render, target, mask), ColorCorrectedPsnr(render, target), ColorCorrectedPsnr(render, target, mask)};
  };
  const std::vector<double> one = scores(1), three = scores(3);
  SetNumThreads(before);
  EXPECT_EQ(one, three);
}

TEST(Metrics, RefuseBuffersThatDoNotFit) {
  const Buffer<float> a = Noise({4, 5, 3}, 1);
  EXPECT_THROW(Psnr(a, Noise({5, 4, 3}, 2)), ShapeError);
  EXPECT_THROW(Ssim(a, a, Buffer<float>::Full({5, 4}, 1.f)), ShapeError);
  EXPECT_THROW(ColorCorrectedPsnr(Noise({4, 5}, 3), a), ShapeError);
}

}  // namespace
}  // namespace oraclegs
