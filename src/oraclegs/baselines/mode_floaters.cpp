#include "oraclegs/baselines/mode_floaters.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "oraclegs/train/train_device.h"

namespace oraclegs {
namespace {

/// A view's measurements, kept between the two passes.
struct ViewDifferences {
  RayModes modes;
  std::vector<float> differences;
  std::vector<float> positive;  ///< ascending
};

ViewDifferences Measure(const RayView& view) {
  ViewDifferences out;
  out.modes = view.FindModes();
  out.differences = ModeDifferences(out.modes);
  for (const float d : out.differences) {
    if (d > 0) out.positive.push_back(d);
  }
  std::sort(out.positive.begin(), out.positive.end());
  return out;
}

/// Percentile of ascending, non-empty numbers, linearly interpolated.
double PercentileInOrder(const std::vector<float>& numbers, double percentile) {
  const double at = std::clamp(percentile / 100, 0.0, 1.0) * static_cast<double>(numbers.size() - 1);
  const auto below = static_cast<size_t>(at);
  const auto low = static_cast<double>(numbers[below]);
  const auto high = static_cast<double>(numbers[std::min(below + 1, numbers.size() - 1)]);
  return low + (at - static_cast<double>(below)) * (high - low);
}

}  // namespace

std::vector<float> ModeDifferences(const RayModes& modes) {
  const size_t n = modes.blended_depth.size();
  std::vector<float> differences(n, 0.f);
  if (n < 2) return differences;
  double sum = 0, squares = 0, least = std::numeric_limits<double>::infinity();
  for (const float depth : modes.blended_depth) {
    sum += static_cast<double>(depth);
    least = std::min(least, static_cast<double>(depth));
  }
  const double mean = sum / static_cast<double>(n);
  for (const float depth : modes.blended_depth) squares += std::pow(static_cast<double>(depth) - mean, 2);
  const double offset = std::max(least, mean - 3 * std::sqrt(squares / static_cast<double>(n - 1)));
  for (size_t i = 0; i < n; ++i) {
    const auto blended = static_cast<double>(modes.blended_depth[i]);
    if (blended + offset > 0) {
      differences[i] = static_cast<float>((blended - static_cast<double>(modes.mode_depth[i])) / (blended + offset));
    }
  }
  return differences;
}

double FloaterPercentile(double mean_dip, const ModeFloaterOptions& options) {
  return std::max(options.min_percentile, options.percentile * std::exp(-options.dip_rate * mean_dip));
}

std::vector<uint8_t> FindModeFloaters(const Gaussians& gaussians, const std::vector<Camera>& cameras,
                                      const RenderOptions& render, const ModeFloaterOptions& options) {
  std::vector<uint8_t> floaters(static_cast<size_t>(gaussians.size()), 0);
  std::vector<ViewDifferences> views;
  double dips = 0;
  for (const Camera& camera : cameras) {
    views.push_back(Measure(RayView(gaussians, camera, render)));
    dips += DipStatistic(views.back().positive);
  }
  if (views.empty()) return floaters;
  const double percentile = FloaterPercentile(dips / static_cast<double>(views.size()), options);
  for (size_t v = 0; v < views.size(); ++v) {
    const ViewDifferences& view = views[v];
    if (view.positive.empty()) continue;
    const double threshold = PercentileInOrder(view.positive, percentile);
    const RayView rays(gaussians, cameras[v], render);  // once more: the lists of all views may not fit in memory
    for (size_t i = 0; i < view.differences.size(); ++i) {
      if (static_cast<double>(view.differences[i]) <= threshold) continue;
      rays.MarkUpToMode(view.modes, static_cast<int64_t>(i), options.min_log_falloff, &floaters);
    }
  }
  return floaters;
}

PruneModes::PruneModes(const BaselineSetup& setup)
    : at_(setup.baseline.prune_modes_at),
      antialiased_(setup.options.antialiased),
      background_(setup.background),
      cameras_(Cameras(setup.data.photos)) {}

double PruneModes::BeforeView(const Iteration& iteration, TrainedModel* model, PartGradients*) {
  if (iteration.number != at_) return 0;
  const RenderOptions render{background_, iteration.sh_degree, antialiased_};
  OnHost(model, [&](TrainedModel* host) {
    const std::vector<uint8_t> floaters = FindModeFloaters(host->gaussians, cameras_, render, {});
    for (int64_t i = 0; i < host->gaussians.size(); ++i) {
      if (floaters[static_cast<size_t>(i)] == 0) continue;
      host->gaussians.opacity_logits[i] = kRemovedLogit;
      host->adam.m.opacity_logits[i] = host->adam.v.opacity_logits[i] = 0;
    }
  });
  return 0;
}

}  // namespace oraclegs
