#include "oraclegs/train/exposure.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/camera/scene_bounds.h"
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

/// Writes A in + b to `out`, pixel by pixel; they may be one.
void ShowPixels(const ExposureMap& map, const float* in, int64_t pixels, float* out) {
  ParallelBlocks(pixels, kExposureGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = 3 * begin; i < 3 * end; i += 3) ShowPixel(map.data(), in + i, out + i);
  });
}

}  // namespace

ExposureMap ExposureAt(const Camera& camera, const std::vector<Camera>& photos, const std::vector<ExposureMap>& maps) {
  if (photos.empty() || maps.size() != photos.size()) {
    throw ShapeError("ExposureAt: {} maps of {} photos", maps.size(), photos.size());
  }
  const double ball = LookedAt(photos).radius, radius = ball > 0 ? ball : 1;
  std::vector<double> distances;
  for (const Camera& photo : photos) {
    distances.push_back((photo.Center() - camera.Center()).norm() / radius + TurnBetween(photo, camera));
  }
  std::vector<double> order = distances;
  std::sort(order.begin(), order.end());
  if (!(order.front() > 0) || order.size() == 1) {
    return maps[static_cast<size_t>(std::min_element(distances.begin(), distances.end()) - distances.begin())];
  }
  double sum = 0;
  std::array<double, 12> mean{};
  for (size_t k = 0; k < maps.size(); ++k) {
    const double weight = std::exp(-std::pow(distances[k] / order[1], 2));
    for (size_t i = 0; i < mean.size(); ++i) mean[i] += weight * static_cast<double>(maps[k][i]);
    sum += weight;
  }
  ExposureMap map;
  for (size_t i = 0; i < mean.size(); ++i) map[i] = static_cast<float>(mean[i] / sum);
  return map;
}

void ShowThrough(const ExposureMap& map, const Buffer<float>& image) {
  RequireShape("ShowThrough", "image", image, {-1, -1, 3});
  ShowPixels(map, image.data(), image.count() / 3, image.data());
}

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
  ShowPixels(state_.maps[view], image.data(), image.size(0) * image.size(1), shown.data());
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
