#include "oraclegs/train/exposure.h"

#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/train/exposure_math.h"
#include "oraclegs/train/train_math.h"

namespace oraclegs {
namespace {

constexpr int64_t kExposureGrain = 1 << 13;  // pixels a task

void RequirePair(const char* who, const Buffer<float>& image, const Buffer<float>& other) {
  RequireShape(who, "image", image, {-1, -1, 3});
  RequireShape(who, "its partner", other, {image.size(0), image.size(1), 3});
}

}  // namespace

Exposures::Exposures(std::vector<ExposureMap> start) {
  if (start.empty()) throw ShapeError("Exposures: there is no photo");
  for (const ExposureMap& map : start) {
    for (const float value : map) {
      if (!std::isfinite(value)) throw ShapeError("Exposures: a start map holds {}", value);
    }
  }
  const size_t views = start.size();
  state_ = {std::move(start), std::vector<ExposureMap>(views), std::vector<ExposureMap>(views),
            std::vector<int64_t>(views)};
  FixGauge();
}

void Exposures::Apply(int view, const Buffer<float>& image, const Buffer<float>& shown) const {
  RequirePair("Exposures::Apply", image, shown);
  const ExposureMap& a = state_.maps[view];
  const float* in = image.data();
  float* out = shown.data();
  ParallelBlocks(image.size(0) * image.size(1), kExposureGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = 3 * begin; i < 3 * end; i += 3) ShowPixel(a.data(), in + i, out + i);
  });
}

ExposureGradient Exposures::Backward(int view, const Buffer<float>& image, const Buffer<float>& grad) {
  RequirePair("Exposures::Backward", image, grad);
  const int64_t pixels = image.size(0) * image.size(1);
  const ExposureMap& a = state_.maps[view];
  const float* in = image.data();
  float* g = grad.data();
  sums_.resize((pixels + kExposureGrain - 1) / kExposureGrain);
  ParallelBlocks(pixels, kExposureGrain, [&](int64_t begin, int64_t end) {
    ExposureGradient sum{};
    for (int64_t i = 3 * begin; i < 3 * end; i += 3) ShowPixelBackward(a.data(), in + i, g + i, sum.data());
    sums_[begin / kExposureGrain] = sum;
  });
  ExposureGradient total{};
  for (const ExposureGradient& sum : sums_) {
    for (size_t k = 0; k < total.size(); ++k) total[k] += sum[k];
  }
  return total;
}

double Exposures::AddRegularizer(int view, double weight, ExposureGradient* gradient) const {
  return RegularizeExposure(state_.maps[view].data(), weight, gradient->data());
}

void Exposures::Step(int view, const ExposureGradient& gradient, double learning_rate) {
  const double t = static_cast<double>(++state_.steps[view]);
  for (size_t k = 0; k < gradient.size(); ++k) {
    ExposureEntry entry{state_.maps[view][k], state_.m[view][k], state_.v[view][k]};
    StepExposure(gradient[k], t, learning_rate, &entry);
    state_.maps[view][k] = entry.value;
    state_.m[view][k] = entry.m;
    state_.v[view][k] = entry.v;
  }
  FixGauge();
}

void Exposures::FixGauge() {
  ExposureGradient mean{};
  for (const ExposureMap& map : state_.maps) {
    for (size_t k = 0; k < mean.size(); ++k) mean[k] += static_cast<double>(map[k]);
  }
  for (double& value : mean) value /= static_cast<double>(state_.maps.size());
  double inverse[9];
  const double determinant = InvertExposure(mean.data(), inverse);
  if (!(std::abs(determinant) > kMinExposureDeterminant)) {
    throw ShapeError("Exposures: the mean of the maps has determinant {}, there is no way back to the identity",
                     determinant);
  }
  for (ExposureMap& map : state_.maps) MoveExposureGauge(inverse, mean.data(), map.data());
}

void Exposures::Restore(const ExposureState& state) {
  const size_t views = state_.maps.size();
  if (state.maps.size() != views || state.m.size() != views || state.v.size() != views || state.steps.size() != views) {
    throw InputError("the checkpoint holds exposure maps of {} photos, this run has {}", state.maps.size(), views);
  }
  state_ = state;
}

}  // namespace oraclegs
