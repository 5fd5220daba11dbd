#include "oraclegs/baselines/adaptive_density.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "oraclegs/baselines/unpool.h"
#include "oraclegs/camera/scene_bounds.h"
#include "oraclegs/core/rng.h"
#include "oraclegs/train/densify.h"
#include "oraclegs/train/opacity_factors.h"
#include "oraclegs/train/train_device.h"
#include "oraclegs/train/train_math.h"

namespace oraclegs {
namespace {

double LargestScale(const Gaussians& gaussians, int64_t i) {
  const float* s = gaussians.log_scales.data() + 3 * i;
  return std::exp(static_cast<double>(std::max({s[0], s[1], s[2]})));
}

/// Three standard normal numbers (Box-Muller), a pure function of seed, iteration and number.
std::array<double, 3> Normals(const DensityControl& control, uint64_t number) {
  constexpr double kTwoPi = 6.283185307179586;
  std::array<double, 4> normals{};
  const auto stream = static_cast<uint64_t>(RandomStream::kSplit);
  const Philox r = Philox::Draw(control.seed, stream, static_cast<uint64_t>(control.iteration) << 32 | number);
  for (size_t pair = 0; pair < 2; ++pair) {
    const double u = static_cast<double>(OpenUniform(r.x[2 * pair]));
    const double v = static_cast<double>(OpenUniform(r.x[2 * pair + 1]));
    const double radius = std::sqrt(-2 * std::log(u));
    normals[2 * pair] = radius * std::cos(kTwoPi * v);
    normals[2 * pair + 1] = radius * std::sin(kTwoPi * v);
  }
  return {normals[0], normals[1], normals[2]};
}

/// R(q) x.
std::array<double, 3> Rotate(const float* quat, const std::array<double, 3>& x) {
  double w = quat[0], a = quat[1], b = quat[2], c = quat[3];
  const double norm = std::sqrt(w * w + a * a + b * b + c * c);
  if (norm > 0) w /= norm, a /= norm, b /= norm, c /= norm;
  return {(1 - 2 * (b * b + c * c)) * x[0] + 2 * (a * b - w * c) * x[1] + 2 * (a * c + w * b) * x[2],
          2 * (a * b + w * c) * x[0] + (1 - 2 * (a * a + c * c)) * x[1] + 2 * (b * c - w * a) * x[2],
          2 * (a * c - w * b) * x[0] + 2 * (b * c + w * a) * x[1] + (1 - 2 * (a * a + b * b)) * x[2]};
}

/// Rows of the Gaussians to clone or split; each adds one Gaussian.
std::vector<int64_t> Pulled(const DensityControl& control, const std::vector<float>& gradients,
                            const Gaussians& gaussians) {
  std::vector<bool> isolated(gradients.size(), false);
  if (control.splits_isolated) {
    for (const int64_t i : IsolatedGaussians(ProximityLimits::Split(control.extent), gaussians)) {
      isolated[static_cast<size_t>(i)] = true;
    }
  }
  std::vector<int64_t> pulled;
  for (size_t i = 0; i < gradients.size(); ++i) {
    const auto row = static_cast<int64_t>(i);
    const bool grows = static_cast<double>(gradients[i]) >= control.gradient &&
                       OpacityOf(gaussians.opacity_logits[row]) > control.opacity_to_grow;
    if (grows || isolated[i]) pulled.push_back(row);
  }
  const auto room =
      static_cast<size_t>(std::max<int64_t>(0, control.max_gaussians - static_cast<int64_t>(gradients.size())));
  if (pulled.size() <= room) return pulled;
  const auto harder = [&](int64_t a, int64_t b) {
    const float ga = gradients[static_cast<size_t>(a)], gb = gradients[static_cast<size_t>(b)];
    return ga != gb ? ga > gb : a < b;
  };
  std::sort(pulled.begin(), pulled.end(), harder);
  pulled.resize(room);
  std::sort(pulled.begin(), pulled.end());
  return pulled;
}

void ZeroMoments(int64_t begin, int64_t end, Adam* adam) {
  adam->ForEachMoment([&](const char*, const char*, auto& t) { t.Rows(begin, end).SetZero(); });
}

/// Moves Gaussian `row` to one half of the split one, in its place.
void MoveToHalf(const DensityControl& control, uint64_t number, int64_t row, Gaussians* gaussians) {
  float* mean = gaussians->means.data() + 3 * row;
  float* log_scales = gaussians->log_scales.data() + 3 * row;
  std::array<double, 3> offset = Normals(control, number);
  for (size_t axis = 0; axis < 3; ++axis) offset[axis] *= std::exp(static_cast<double>(log_scales[axis]));
  offset = Rotate(gaussians->quats.data() + 4 * row, offset);
  for (size_t axis = 0; axis < 3; ++axis) {
    mean[axis] = static_cast<float>(static_cast<double>(mean[axis]) + offset[axis]);
    log_scales[axis] = static_cast<float>(static_cast<double>(log_scales[axis]) - std::log(kSplitShrink));
  }
}

/// Rows of the Gaussians that are neither too transparent nor too large.
std::vector<int64_t> RowsThatStay(const DensityControl& control, const Gaussians& gaussians) {
  std::vector<int64_t> rows;
  int64_t most_opaque = 0;
  for (int64_t i = 0; i < gaussians.size(); ++i) {
    const float logit = gaussians.opacity_logits[i];
    if (logit > gaussians.opacity_logits[most_opaque]) most_opaque = i;
    if (OpacityOf(logit) < control.least_opacity) continue;
    if (control.removes_large && LargestScale(gaussians, i) > kLargeShare * control.extent) continue;
    rows.push_back(i);
  }
  if (rows.empty()) rows.push_back(most_opaque);
  return rows;
}

// Names in the checkpoint.
constexpr const char *kScreenSum = "screen_gradients", *kScreenViews = "screen_views";

class AdaptiveDensifier final : public Densifier {
 public:
  AdaptiveDensifier(const BaselineSettings& settings, bool is_background_white, const DensifierSetup& setup)
      : settings_(settings),
        is_background_white_(is_background_white),
        options_(setup.options),
        rasterizer_(setup.rasterizer),
        device_(setup.device),
        extent_(SpatialExtent(Cameras(setup.plan.photos()))) {}
  ~AdaptiveDensifier() override { rasterizer_->WatchScreen(nullptr); }

  bool Acts(const Iteration& iteration) const override { return iteration.refines || Resets(iteration); }

  void Refine(const Iteration& iteration, TrainedModel* model) override {
    OnHost(model, [&](TrainedModel* host) {
      if (iteration.refines) Control(iteration, host);
      if (Resets(iteration)) ResetOpacities(settings_.opacity_reset_to, &host->gaussians, &host->adam);
    });
  }

  void Begin(int64_t gaussians) override {
    screen_ = {Buffer<float>::Zeros({gaussians}, device_), Buffer<float>::Zeros({gaussians}, device_)};
    rasterizer_->WatchScreen(&screen_);
  }

  void Save(NamedState* state) const override {
    state->arrays[kScreenSum] = screen_.sum.CopyOn(kCpu);
    state->arrays[kScreenViews] = screen_.views.CopyOn(kCpu);
  }

  void Restore(const NamedState& state, int64_t gaussians) override {
    screen_ = {state.Array(kScreenSum, {gaussians}).To(device_), state.Array(kScreenViews, {gaussians}).To(device_)};
    rasterizer_->WatchScreen(&screen_);
  }

 private:
  bool Resets(const Iteration& iteration) const {
    return ResetsOpacities(settings_, options_, is_background_white_, iteration.number);
  }

  /// Refines a model on the host.
  void Control(const Iteration& iteration, TrainedModel* model) {
    const BaselineSettings& baseline = settings_;
    const int64_t reset = baseline.opacity_reset;
    DensityControl control{iteration.seed, iteration.number, baseline.densify_gradient, extent_,
                           options_.max_gaussians};
    control.least_opacity = baseline.prune_opacity;
    control.opacity_to_grow = baseline.densify_opacity;
    control.splits_isolated = baseline.proximity_split;
    control.removes_large = !baseline.keep_large && reset > 0 && extent_ > 0 && iteration.number > reset;
    const auto unpool = [&](Gaussians* gaussians, Adam* adam) {
      if (iteration.number >= baseline.unpool_until) return;
      UnpoolGaussians(ProximityLimits::Unpool(extent_), options_.max_gaussians, gaussians);
      adam->GrowTo(gaussians->size());
    };
    ControlDensity(control, MeanGradients(iteration), &model->gaussians, &model->adam, unpool);
    Begin(model->gaussians.size());
  }

  /// Mean screen gradient of each Gaussian. One that dropout leaves out is not counted as seen; the published programs
  /// count it as seen without gradient.
  std::vector<float> MeanGradients(const Iteration& iteration) const {
    const double kept = 1 - DropProbability(options_.dropout, iteration.number, options_.iterations);
    const Buffer<float> sums = screen_.sum.To(kCpu), views = screen_.views.To(kCpu);
    std::vector<float> gradients(static_cast<size_t>(sums.count()), 0);
    for (int64_t i = 0; i < sums.count(); ++i) {
      if (views[i] == 0) continue;
      gradients[static_cast<size_t>(i)] = static_cast<float>(kept) * sums[i] / views[i];
    }
    return gradients;
  }

  BaselineSettings settings_;
  bool is_background_white_;
  const TrainOptions& options_;
  Rasterizer* rasterizer_;
  Device device_;
  double extent_;
  ScreenGradients screen_;
};

}  // namespace

DensityChange ControlDensity(const DensityControl& control, const std::vector<float>& gradients, Gaussians* gaussians,
                             Adam* adam, const AlsoGrow& also) {
  gaussians->Check("ControlDensity");
  const int64_t n = gaussians->size();
  adam->Check("ControlDensity", n);
  if (static_cast<int64_t>(gradients.size()) != n) {
    throw ShapeError("ControlDensity: {} gradients, expected {}", gradients.size(), n);
  }
  std::vector<int64_t> clones, splits;
  for (const int64_t i : Pulled(control, gradients, *gaussians)) {
    (LargestScale(*gaussians, i) <= kDenseShare * control.extent ? clones : splits).push_back(i);
  }
  DensityChange change{static_cast<int64_t>(clones.size()), static_cast<int64_t>(splits.size())};

  std::vector<int64_t> rows(static_cast<size_t>(n));
  for (int64_t i = 0; i < n; ++i) rows[static_cast<size_t>(i)] = i;
  rows.insert(rows.end(), clones.begin(), clones.end());
  for (int copy = 0; copy < 2; ++copy) rows.insert(rows.end(), splits.begin(), splits.end());
  KeepRows(rows, gaussians, adam);
  const auto all = static_cast<int64_t>(rows.size());
  ZeroMoments(n, all, adam);
  const int64_t halves = n + change.cloned;
  for (int64_t row = halves; row < all; ++row) {
    MoveToHalf(control, static_cast<uint64_t>(row - halves), row, gaussians);
  }

  std::vector<bool> is_split(static_cast<size_t>(n), false);
  for (const int64_t i : splits) is_split[static_cast<size_t>(i)] = true;
  rows.clear();
  for (int64_t i = 0; i < all; ++i) {
    if (i >= n || !is_split[static_cast<size_t>(i)]) rows.push_back(i);
  }
  if (!splits.empty()) KeepRows(rows, gaussians, adam);
  if (also) also(gaussians, adam);
  const std::vector<int64_t> left = RowsThatStay(control, *gaussians);
  change.removed = gaussians->size() - static_cast<int64_t>(left.size());
  if (change.removed > 0) KeepRows(left, gaussians, adam);
  return change;
}

void ResetOpacities(double most, Gaussians* gaussians, Adam* adam) {
  const auto highest = static_cast<float>(LogitOf(most));
  for (float& logit : gaussians->opacity_logits.span()) logit = std::min(logit, highest);
  adam->m.opacity_logits.SetZero();
  adam->v.opacity_logits.SetZero();
}

bool ResetsOpacities(const BaselineSettings& settings, const TrainOptions& options, bool is_background_white,
                     int64_t iteration) {
  const int64_t every = settings.opacity_reset, first = settings.opacity_reset_first.value_or(settings.opacity_reset);
  if (every == 0 || !options.IsBeforeRefineStop(iteration)) return false;
  const bool is_start = is_background_white && !settings.opacity_reset_first && iteration == options.refine_start;
  return is_start || (iteration >= first && (iteration - first) % every == 0);
}

DensifierMaker AdaptiveDensifierMaker(const BaselineSettings& settings, const std::array<float, 3>& background) {
  const bool is_white = background == std::array<float, 3>{1, 1, 1};
  return [settings, is_white](const DensifierSetup& setup) {
    return std::make_unique<AdaptiveDensifier>(settings, is_white, setup);
  };
}

}  // namespace oraclegs
