#include "oraclegs/train/exposure.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/train/train_math.h"

namespace oraclegs {
namespace {

constexpr int64_t kExposureGrain = 1 << 13;  // pixels a task

using Matrix34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

Matrix34 ToMatrix(const ExposureMap& map) {
  return Eigen::Map<const Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>(map.data()).cast<double>();
}

void RequirePair(const char* who, const Buffer<float>& image, const Buffer<float>& other) {
  RequireShape(who, "image", image, {-1, -1, 3});
  RequireShape(who, "its partner", other, {image.size(0), image.size(1), 3});
}

/// Returns dL/d(map) of pixels [begin, end), the sum of grad (image, 1)', and multiplies grad by A'.
ExposureGradient BackwardPixels(const ExposureMap& a, const float* image, float* grad, int64_t begin, int64_t end) {
  ExposureGradient sum{};
  for (int64_t i = begin; i < end; ++i) {
    const float* x = image + 3 * i;
    float* g = grad + 3 * i;
    const float g0 = g[0], g1 = g[1], g2 = g[2];
    for (int k = 0; k < 3; ++k) {
      sum[k] += static_cast<double>(g0 * x[k]);
      sum[4 + k] += static_cast<double>(g1 * x[k]);
      sum[8 + k] += static_cast<double>(g2 * x[k]);
      g[k] = a[k] * g0 + a[4 + k] * g1 + a[8 + k] * g2;
    }
    sum[3] += static_cast<double>(g0);
    sum[7] += static_cast<double>(g1);
    sum[11] += static_cast<double>(g2);
  }
  return sum;
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
    for (int64_t i = 3 * begin; i < 3 * end; i += 3) {
      const float r = in[i], g = in[i + 1], b = in[i + 2];
      for (int k = 0; k < 3; ++k) out[i + k] = a[4 * k] * r + a[4 * k + 1] * g + a[4 * k + 2] * b + a[4 * k + 3];
    }
  });
}

ExposureGradient Exposures::Backward(int view, const Buffer<float>& image, const Buffer<float>& grad) {
  RequirePair("Exposures::Backward", image, grad);
  const int64_t pixels = image.size(0) * image.size(1);
  const float* in = image.data();
  float* g = grad.data();
  sums_.resize((pixels + kExposureGrain - 1) / kExposureGrain);
  ParallelBlocks(pixels, kExposureGrain, [&](int64_t begin, int64_t end) {
    sums_[begin / kExposureGrain] = BackwardPixels(state_.maps[view], in, g, begin, end);
  });
  ExposureGradient total{};
  for (const ExposureGradient& sum : sums_) {
    for (size_t k = 0; k < total.size(); ++k) total[k] += sum[k];
  }
  return total;
}

double Exposures::AddRegularizer(int view, double weight, ExposureGradient* gradient) const {
  double squares = 0;
  for (size_t k = 0; k < gradient->size(); ++k) {
    const double offset = static_cast<double>(state_.maps[view][k]) - static_cast<double>(kIdentityExposure[k]);
    squares += offset * offset;
    (*gradient)[k] += weight * offset;
  }
  return 0.5 * weight * squares;
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
  Matrix34 mean = Matrix34::Zero();
  for (const ExposureMap& map : state_.maps) mean += ToMatrix(map);
  mean /= static_cast<double>(state_.maps.size());
  const Eigen::Matrix3d matrix = mean.leftCols<3>();
  if (!(std::abs(matrix.determinant()) > kMinExposureDeterminant)) {
    throw ShapeError("Exposures: the mean of the maps has determinant {}, there is no way back to the identity",
                     matrix.determinant());
  }
  const Eigen::Matrix3d inverse = matrix.inverse();
  for (ExposureMap& map : state_.maps) {
    Matrix34 fixed = ToMatrix(map);
    fixed.leftCols<3>() = (fixed.leftCols<3>() * inverse).eval();
    fixed.col(3) -= (fixed.leftCols<3>() * mean.col(3)).eval();
    Eigen::Map<Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>(map.data()) = fixed.cast<float>();
  }
}

void Exposures::Restore(const ExposureState& state) {
  const size_t views = state_.maps.size();
  if (state.maps.size() != views || state.m.size() != views || state.v.size() != views || state.steps.size() != views) {
    throw InputError("the checkpoint holds exposure maps of {} photos, this run has {}", state.maps.size(), views);
  }
  state_ = state;
}

}  // namespace oraclegs
