#include "oraclegs/validate/features.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/validate/integral.h"

namespace oraclegs {
namespace {

constexpr int kRadius = 3;      // half side of a patch
constexpr float kFlat = 0.01f;  // standard deviation of brightness below which a patch has no structure
constexpr float kMaxAngle = 90, kMaxRing = 200;
constexpr float kBorder = 0.1f;  // share of the image's smaller side

float Luma(const float* rgb) { return 0.299f * rgb[0] + 0.587f * rgb[1] + 0.114f * rgb[2]; }

float Distance(const float* a, const float* b) {
  float squares = 0;
  for (int c = 0; c < 3; ++c) squares += (a[c] - b[c]) * (a[c] - b[c]);
  return std::sqrt(squares / 3);
}

/// Compresses values that span orders of magnitude.
float Log(float value, float floor) { return std::log(floor + std::max(value, 0.f)); }

/// Largest relative difference of inverse depth in the 5x5 pixels around (x, y).
float DepthEdge(const std::vector<float>& inv_depth, int width, int height, int x, int y) {
  float low = 1e30f, high = 0;
  for (int v = std::max(0, y - 2); v <= std::min(height - 1, y + 2); ++v) {
    for (int u = std::max(0, x - 2); u <= std::min(width - 1, x + 2); ++u) {
      const float w = inv_depth[static_cast<size_t>(v) * width + u];
      low = std::min(low, w), high = std::max(high, w);
    }
  }
  return high > 0 ? (high - low) / high : 0;
}

}  // namespace

std::vector<Features> FeaturesOf(const Proposal& proposal, const WarpedView& warped) {
  const int width = proposal.camera.width, height = proposal.camera.height;
  const auto pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  const float* a = proposal.rgb.data.data();
  const float* b = warped.rgb.data.data();
  std::vector<float> la(pixels), lb(pixels), distance(pixels);
  for (size_t i = 0; i < pixels; ++i) {
    la[i] = Luma(a + 3 * i), lb[i] = Luma(b + 3 * i), distance[i] = Distance(a + 3 * i, b + 3 * i);
  }
  const Integral sum_a(width, height, [&](size_t i) { return la[i]; });
  const Integral sum_b(width, height, [&](size_t i) { return lb[i]; });
  const Integral sum_aa(width, height, [&](size_t i) { return la[i] * la[i]; });
  const Integral sum_bb(width, height, [&](size_t i) { return lb[i] * lb[i]; });
  const Integral sum_ab(width, height, [&](size_t i) { return la[i] * lb[i]; });
  const Integral sum_d(width, height, [&](size_t i) { return distance[i]; });
  std::vector<Features> features(pixels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * width + x;
      const PixelEvidence& e = warped.evidence[i];
      const Window patch = Window::Around(x, y, kRadius, width, height);
      const double mean_a = sum_a.Mean(patch), mean_b = sum_b.Mean(patch);
      const double var_a = std::max(0.0, sum_aa.Mean(patch) - mean_a * mean_a);
      const double var_b = std::max(0.0, sum_bb.Mean(patch) - mean_b * mean_b);
      const double covariance = sum_ab.Mean(patch) - mean_a * mean_b;
      const double flat = static_cast<double>(kFlat) * kFlat;
      // 1 - SSIM's structure term: patches without texture agree.
      const auto structure = static_cast<float>(1 - (covariance + flat) / (std::sqrt(var_a * var_b) + flat));
      float depth = 0;
      if (!proposal.inv_depth.empty() && proposal.inv_depth[i] > 0 && warped.inv_depth[i] > 0) {
        depth = std::abs(std::log(proposal.inv_depth[i] / warped.inv_depth[i]));
      }
      const float spread = proposal.source == kMixed && !proposal.spread.empty() ? proposal.spread[i] : 0;
      const size_t left = i - (x > 0 ? 1 : 0), right = i + (x + 1 < width ? 1 : 0);
      const size_t above = y > 0 ? i - static_cast<size_t>(width) : i;
      const size_t below = y + 1 < height ? i + static_cast<size_t>(width) : i;
      const auto to_border = static_cast<float>(std::min({x, y, width - 1 - x, height - 1 - y}));
      features[i] = {Log(e.support, 0.02f),
                     Log(e.views, 0.2f),
                     std::sqrt(std::min(e.angle, kMaxAngle)),
                     Log(e.spread, 0.005f),
                     e.confidence,
                     Log(e.conflicts, 0.1f),
                     Log(e.occluded, 0.1f),
                     std::log1p(std::min(e.ring, kMaxRing)),
                     e.resolution,
                     e.background,
                     Log(DepthEdge(warped.inv_depth, width, height, x, y), 0.005f),
                     Log(static_cast<float>(std::sqrt(var_a)), 0.005f),
                     Log(distance[i], 0.005f),
                     Log(static_cast<float>(sum_d.Mean(patch)), 0.005f),
                     structure,
                     Log(std::min(depth, 1.f), 0.002f),
                     Log(spread, 0.005f),
                     Log(std::hypot(la[right] - la[left], la[below] - la[above]), 0.005f),
                     la[i],
                     std::exp(-to_border / (kBorder * static_cast<float>(std::min(width, height))))};
    }
  }
  return features;
}

}  // namespace oraclegs
