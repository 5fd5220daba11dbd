#include "oraclegs/depth/local_warp.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

// Relative errors that quarter a sample's weight, by round: at first nearly all samples contribute, in the end those
// that fit.
constexpr std::array<double, 6> kErrorScales = {0.8, 0.4, 0.2, 0.1, 0.06, 0.06};
constexpr double kFactorRidge = 1e-3;  // keeps factor and addend apart where they have the same effect
constexpr float kFarShare = 0.1f;      // of the median: smaller truths count like this one

float MedianTruth(const std::vector<DepthSample>& samples) {
  std::vector<float> truths;
  for (const DepthSample& s : samples) truths.push_back(s.truth);
  return UpperMedian(&truths);
}

}  // namespace

LocalWarp::LocalWarp(int width, int height, const std::vector<DepthSample>& samples, const LocalWarpOptions& options) {
  cell_ = std::max(1.f, static_cast<float>(std::max(width, height)) / static_cast<float>(options.cells));
  across_ = static_cast<int>(std::ceil(static_cast<float>(width) / cell_)) + 1;
  down_ = static_cast<int>(std::ceil(static_cast<float>(height) / cell_)) + 1;
  const auto nodes = static_cast<size_t>(across_) * static_cast<size_t>(down_);
  factor_.assign(nodes, 0), addend_.assign(nodes, 0);
  double weights = 0;
  for (const DepthSample& s : samples) weights += static_cast<double>(s.weight);
  if (!(weights > 0)) return;

  const float median = MedianTruth(samples);
  const auto n = static_cast<Eigen::Index>(nodes);
  Eigen::MatrixXd smooth = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  const auto tie = [&](int a, int b) {
    for (const Eigen::Index part : {Eigen::Index{0}, n}) {
      smooth(part + a, part + a) += options.smoothness, smooth(part + b, part + b) += options.smoothness;
      smooth(part + a, part + b) -= options.smoothness, smooth(part + b, part + a) -= options.smoothness;
    }
  };
  for (int y = 0; y < down_; ++y) {
    for (int x = 0; x < across_; ++x) {
      if (x + 1 < across_) tie(y * across_ + x, y * across_ + x + 1);
      if (y + 1 < down_) tie(y * across_ + x, (y + 1) * across_ + x);
    }
  }
  smooth.diagonal().array() += kFactorRidge;

  Eigen::VectorXd solution = Eigen::VectorXd::Zero(2 * n);
  for (const double scale : kErrorScales) {
    Eigen::MatrixXd normal = smooth;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * n);
    for (const DepthSample& s : samples) {
      // Errors are relative to the true value, so they are errors of the depth's logarithm.
      const double unit = 1 / static_cast<double>(std::max(s.truth, kFarShare * median));
      const double derivatives[2] = {unit * static_cast<double>(s.inv_depth), unit * static_cast<double>(median)};
      const double off = unit * (static_cast<double>(s.truth) - static_cast<double>(s.inv_depth));
      const Corners at = CornersOf(s.x, s.y);
      double left = off;
      for (int k = 0; k < 4; ++k) {
        const auto node = static_cast<Eigen::Index>(at.node[k]);
        left -=
            static_cast<double>(at.weight[k]) * (derivatives[0] * solution[node] + derivatives[1] * solution[n + node]);
      }
      const double doubt = 1 + left * left / (scale * scale);
      // Every node has the weight of one sample on average, whatever the number of pixels.
      const double w = static_cast<double>(s.weight) * static_cast<double>(nodes) / weights / (doubt * doubt);
      for (int k = 0; k < 8; ++k) {
        const auto i = static_cast<Eigen::Index>(at.node[k % 4]) + (k < 4 ? 0 : n);
        const double si = static_cast<double>(at.weight[k % 4]) * derivatives[k / 4];
        right[i] += w * si * off;
        for (int l = 0; l < 8; ++l) {
          const auto j = static_cast<Eigen::Index>(at.node[l % 4]) + (l < 4 ? 0 : n);
          normal(i, j) += w * si * static_cast<double>(at.weight[l % 4]) * derivatives[l / 4];
        }
      }
    }
    solution = normal.ldlt().solve(right);
  }
  for (size_t i = 0; i < nodes; ++i) {
    factor_[i] = static_cast<float>(solution[static_cast<Eigen::Index>(i)]);
    addend_[i] = median * static_cast<float>(solution[n + static_cast<Eigen::Index>(i)]);
  }
}

LocalWarp::Corners LocalWarp::CornersOf(float x, float y) const {
  const float u = std::clamp(x / cell_, 0.f, static_cast<float>(across_ - 1));
  const float v = std::clamp(y / cell_, 0.f, static_cast<float>(down_ - 1));
  const int x0 = std::clamp(static_cast<int>(u), 0, std::max(0, across_ - 2));
  const int y0 = std::clamp(static_cast<int>(v), 0, std::max(0, down_ - 2));
  const float s = u - static_cast<float>(x0), t = v - static_cast<float>(y0);
  const auto node = static_cast<size_t>(y0) * static_cast<size_t>(across_) + static_cast<size_t>(x0);
  const size_t right = node + 1, below = node + static_cast<size_t>(across_);
  return {{node, right, below, below + 1}, {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t}};
}

float LocalWarp::operator()(float x, float y, float inv_depth) const {
  const Corners at = CornersOf(x, y);
  float factor = 1, addend = 0;
  for (int k = 0; k < 4; ++k) {
    factor += at.weight[k] * factor_[at.node[k]];
    addend += at.weight[k] * addend_[at.node[k]];
  }
  return factor * inv_depth + addend;
}

}  // namespace oraclegs
