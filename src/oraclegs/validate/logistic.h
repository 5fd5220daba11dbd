#pragma once

#include <Eigen/Core>

namespace oraclegs {

/// Logistic regression on features, their squares and their products, standardized: the probability of a soft label.
/// Features are clamped to the range that 99 % of the samples have: a quadratic function says nothing beyond it.
class Logistic {
 public:
  /// Answers 1/2 to everything.
  Logistic() = default;

  /// Minimizes the cross entropy of `labels` in [0, 1] plus a small ridge by Newton's method; rows are samples. A
  /// feature that never changes contributes nothing. The same bits for any number of threads. Throws ShapeError when
  /// rows and labels differ in number or there are none.
  static Logistic Fit(const Eigen::MatrixXf& features, const Eigen::VectorXf& labels);

  /// (0, 1). `features` has as many entries as Fit had columns.
  float operator()(const float* features) const;

 private:
  void FitRange(const Eigen::MatrixXf& features);
  void Standardize(const float* features, float* x) const;
  Eigen::VectorXf Expand(const float* features) const;

  Eigen::VectorXf low_, high_;                ///< of the features, beyond which they are clamped
  Eigen::VectorXf mean_, inverse_deviation_;  ///< of the features; 0 for one that never changes
  Eigen::VectorXf linear_;
  Eigen::MatrixXf quadratic_;  ///< upper triangle
  float constant_ = 0;
};

}  // namespace oraclegs
