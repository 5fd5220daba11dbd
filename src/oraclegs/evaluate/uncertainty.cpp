#include "oraclegs/evaluate/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "oraclegs/core/interrupt.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/evaluate/blended_sums.h"

namespace oraclegs {
namespace {

// The error to expect of a pixel: that of the photos' noise, which no model shows, and a multiple of the deviation of
// the models.
constexpr float kNoise = 0.007f, kErrorOfDeviation = 2.4f;
// Models differ less where photos and proposals taught them than at other places, by this in the median of three.
constexpr float kOfUnseen = 1.35f;
constexpr int kReach = 2;         // px, of the window of 5 x 5 that a deviation is the mean of
constexpr int kStandIns = 2;      // for other models
constexpr double kLeftOut = 0.3;  // share of the Gaussians of a stand-in
constexpr double kUnseenQuantile = 0.98;

/// Standard deviation of the images at each pixel, root mean square over the channels.
std::vector<float> Deviations(const std::vector<Buffer<float>>& images) {
  std::vector<float> deviations(static_cast<size_t>(images.front().count() / 3));
  const auto count = static_cast<float>(images.size());
  for (size_t p = 0; p < deviations.size(); ++p) {
    float squares = 0;
    for (size_t c = 3 * p; c < 3 * p + 3; ++c) {
      float mean = 0;
      for (const Buffer<float>& image : images) mean += image[static_cast<int64_t>(c)] / count;
      for (const Buffer<float>& image : images) {
        const float off = image[static_cast<int64_t>(c)] - mean;
        squares += off * off / count;
      }
    }
    deviations[p] = std::sqrt(squares / 3);
  }
  return deviations;
}

/// Means over lines of 2 kReach + 1 numbers that lie `step` apart, fewer at the ends; `count` numbers from `from` on.
void SmoothLine(const float* from, int count, int step, float* to) {
  for (int i = 0; i < count; ++i) {
    const int first = std::max(0, i - kReach), last = std::min(count - 1, i + kReach);
    float sum = 0;
    for (int k = first; k <= last; ++k) sum += from[static_cast<ptrdiff_t>(k) * step];
    to[static_cast<ptrdiff_t>(i) * step] = sum / static_cast<float>(last - first + 1);
  }
}

std::vector<float> Smoothed(const std::vector<float>& values, int width, int height) {
  std::vector<float> rows(values.size()), all(values.size());
  for (int y = 0; y < height; ++y) {
    const ptrdiff_t at = static_cast<ptrdiff_t>(y) * width;
    SmoothLine(values.data() + at, width, 1, rows.data() + at);
  }
  for (int x = 0; x < width; ++x) SmoothLine(rows.data() + x, height, width, all.data() + x);
  return all;
}

/// Opacity factors that leave some of the Gaussians out, and make the others as much heavier.
Buffer<float> StandInFactors(int64_t n, int number) {
  Buffer<float> factors = Buffer<float>::Empty({n});
  Rng random(0, RandomStream::kStandIns, static_cast<uint64_t>(number) << 32);
  for (int64_t i = 0; i < n; ++i) factors[i] = random.Uniform() < kLeftOut ? 0 : static_cast<float>(1 / (1 - kLeftOut));
  return factors;
}

}  // namespace

Uncertainty::Uncertainty(const Gaussians& model, std::vector<Gaussians> others, const RenderOptions& options)
    : model_(model), others_(std::move(others)), options_(options), rasterizer_(MakeRasterizer(model.device())) {
  members_.push_back({&model_, {}});
  for (const Gaussians& other : others_) members_.push_back({&other, {}});
  for (int k = 0; k < kStandIns && others_.empty(); ++k) {
    members_.push_back({&model_, StandInFactors(model.size(), k).To(model.device())});
  }
}

std::vector<float> Uncertainty::At(const Camera& camera) {
  std::vector<Buffer<float>> images;
  for (const Member& member : members_) {
    RenderOptions options = options_;
    options.opacity_factors = member.factors;
    images.push_back(
        rasterizer_->Forward(*member.gaussians, camera, options, RenderPass::kInference).image.To(kCpu).Clone());
    for (float& value : images.back().span()) value = std::clamp(value, 0.f, 1.f);
  }
  std::vector<float> expected = Smoothed(Deviations(images), camera.width, camera.height);
  for (float& value : expected) value = std::min(1.f, kNoise + kErrorOfDeviation * value);
  return expected;
}

std::vector<float> Uncertainty::OfGaussians(const std::vector<Camera>& views) {
  const int64_t n = model_.size();
  std::vector<double> sums(static_cast<size_t>(n)), weights(static_cast<size_t>(n));
  BlendedSums blended(model_, options_);
  for (const Camera& view : views) {
    ThrowIfInterrupted();
    std::vector<float> expected = At(view);
    for (float& value : expected) value = std::min(1.f, kNoise + kOfUnseen * (value - kNoise));
    Buffer<float> numbers = Buffer<float>::Zeros({view.height, view.width, 3});
    for (size_t p = 0; p < expected.size(); ++p) {
      numbers[static_cast<int64_t>(3 * p)] = expected[p];
      numbers[static_cast<int64_t>(3 * p + 1)] = 1;
    }
    blended.Take(view, numbers);
    for (int64_t i = 0; i < n; ++i) {
      sums[static_cast<size_t>(i)] += std::max(0.0, blended.Of(i, 0));
      weights[static_cast<size_t>(i)] += std::max(0.0, blended.Of(i, 1));
    }
  }
  std::vector<float> of_seen, uncertainty(static_cast<size_t>(n));
  for (size_t i = 0; i < sums.size(); ++i) {
    if (!(weights[i] > 0)) continue;
    uncertainty[i] = static_cast<float>(std::min(1.0, sums[i] / weights[i]));
    of_seen.push_back(uncertainty[i]);
  }
  float of_unseen = 1;
  if (!of_seen.empty()) {
    const auto at =
        of_seen.begin() + static_cast<ptrdiff_t>(std::ceil(kUnseenQuantile * static_cast<double>(of_seen.size() - 1)));
    std::nth_element(of_seen.begin(), at, of_seen.end());
    of_unseen = *at;
  }
  for (size_t i = 0; i < sums.size(); ++i) {
    if (!(weights[i] > 0)) uncertainty[i] = of_unseen;
  }
  return uncertainty;
}

}  // namespace oraclegs
