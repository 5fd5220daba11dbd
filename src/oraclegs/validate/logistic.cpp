#include "oraclegs/validate/logistic.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "oraclegs/core/error.h"
#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

constexpr size_t kMaxFeatures = 64;
constexpr float kMaxDeviation = 3;  // clamp of standardized features
constexpr double kTail = 0.005;     // share of the samples beyond either end of a feature's range
constexpr double kRidge = 1e-3;     // for each sample, on standardized features
constexpr int kNewtonSteps = 8;
constexpr double kConverged = 1e-4;  // change of a weight
constexpr int64_t kBlock = 4096;     // number of samples

/// Value below which `share` of the values lie.
float Quantile(std::vector<float>* values, double share) {
  const auto place = static_cast<int64_t>(share * static_cast<double>(values->size() - 1) + 0.5);
  std::nth_element(values->begin(), values->begin() + place, values->end());
  return (*values)[static_cast<size_t>(place)];
}

}  // namespace

void Logistic::Standardize(const float* features, float* x) const {
  for (Eigen::Index i = 0; i < mean_.size(); ++i) {
    const float taught = std::clamp(features[i], low_[i], high_[i]);
    x[i] = std::clamp((taught - mean_[i]) * inverse_deviation_[i], -kMaxDeviation, kMaxDeviation);
  }
}

void Logistic::FitRange(const Eigen::MatrixXf& features) {
  const Eigen::Index samples = features.rows(), n = features.cols();
  low_.resize(n), high_.resize(n);
  ParallelFor(n, [&](int64_t i) {
    std::vector<float> values(features.col(i).data(), features.col(i).data() + samples);
    low_[i] = Quantile(&values, kTail);
    high_[i] = Quantile(&values, 1 - kTail);
  });
  mean_ = features.cast<double>().colwise().mean().cast<float>();  // a constant feature has no deviation
  const Eigen::VectorXf deviation =
      ((features.rowwise() - mean_.transpose()).colwise().squaredNorm() / static_cast<float>(samples)).cwiseSqrt();
  inverse_deviation_ = deviation.unaryExpr([](float d) { return d > 1e-6f ? 1 / d : 0.f; });
}

/// Features, their products (the upper triangle, row by row) and 1.
Eigen::VectorXf Logistic::Expand(const float* features) const {
  const Eigen::Index n = mean_.size();
  Eigen::VectorXf expanded(n + n * (n + 1) / 2 + 1);
  Standardize(features, expanded.data());
  Eigen::Index k = n;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = i; j < n; ++j) expanded[k++] = expanded[i] * expanded[j] / 2;
  }
  expanded[k] = 1;
  return expanded;
}

Logistic Logistic::Fit(const Eigen::MatrixXf& features, const Eigen::VectorXf& labels) {
  const Eigen::Index samples = features.rows();
  if (samples == 0 || labels.size() != samples || features.cols() > Eigen::Index{kMaxFeatures}) {
    throw ShapeError("Logistic: {} samples of {} features (at most {}) and {} labels", samples, features.cols(),
                     kMaxFeatures, labels.size());
  }
  Logistic model;
  model.FitRange(features);
  const Eigen::Index size = model.Expand(features.row(0).eval().data()).size();
  const int64_t blocks = (samples + kBlock - 1) / kBlock;
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(size);
  for (int step = 0; step < kNewtonSteps; ++step) {
    std::vector<Eigen::MatrixXd> hessians(static_cast<size_t>(blocks), Eigen::MatrixXd::Zero(size, size));
    std::vector<Eigen::VectorXd> gradients(static_cast<size_t>(blocks), Eigen::VectorXd::Zero(size));
    ParallelBlocks(samples, kBlock, [&](int64_t begin, int64_t end) {
      Eigen::MatrixXf scaled(size, end - begin);
      Eigen::VectorXd& gradient = gradients[static_cast<size_t>(begin / kBlock)];
      for (int64_t s = begin; s < end; ++s) {
        const Eigen::VectorXf row = features.row(s);
        const Eigen::VectorXf x = model.Expand(row.data());
        const double p = Sigmoid(weights.dot(x.cast<double>()));
        gradient += (p - static_cast<double>(labels[s])) * x.cast<double>();
        scaled.col(s - begin) = x * static_cast<float>(std::sqrt(std::max(p * (1 - p), 1e-4)));
      }
      Eigen::MatrixXf product = Eigen::MatrixXf::Zero(size, size);
      product.selfadjointView<Eigen::Lower>().rankUpdate(scaled);
      hessians[static_cast<size_t>(begin / kBlock)] = product.cast<double>();
    });
    Eigen::MatrixXd hessian = kRidge * static_cast<double>(samples) * Eigen::MatrixXd::Identity(size, size);
    hessian(size - 1, size - 1) = 1e-9;
    Eigen::VectorXd gradient = hessian.diagonal().cwiseProduct(weights);
    for (int64_t b = 0; b < blocks; ++b) {
      hessian += hessians[static_cast<size_t>(b)];
      gradient += gradients[static_cast<size_t>(b)];
    }
    const Eigen::VectorXd change = hessian.ldlt().solve(gradient);
    weights -= change;
    if (change.cwiseAbs().maxCoeff() < kConverged) break;
  }
  const Eigen::Index n = model.mean_.size();
  model.linear_ = weights.head(n).cast<float>();
  model.quadratic_ = Eigen::MatrixXf::Zero(n, n);
  Eigen::Index k = n;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = i; j < n; ++j) model.quadratic_(i, j) = static_cast<float>(weights[k++] / 2);
  }
  model.constant_ = static_cast<float>(weights[k]);
  return model;
}

float Logistic::operator()(const float* features) const {
  const Eigen::Index n = mean_.size();
  if (n == 0) return 0.5f;
  std::array<float, kMaxFeatures> x;
  Standardize(features, x.data());
  float sum = constant_;
  for (Eigen::Index j = 0; j < n; ++j) {
    float column = linear_[j];
    for (Eigen::Index i = 0; i <= j; ++i) column += quadratic_(i, j) * x[static_cast<size_t>(i)];
    sum += column * x[static_cast<size_t>(j)];
  }
  return static_cast<float>(Sigmoid(static_cast<double>(sum)));
}

}  // namespace oraclegs
