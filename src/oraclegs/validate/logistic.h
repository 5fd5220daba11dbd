#pragma once

#include <Eigen/Core>

namespace oraclegs {

/// Logistic regression on standardized features, their squares and their products: the probability of a soft label.
/// Features are clamped to the range that 99 % of the samples have, beyond which a quadratic function is arbitrary.
class Logistic {
 public:
  /// Constant 1/2.
  Logistic() = default;

  /// Minimizes the cross entropy of `labels` in [0, 1] plus a small ridge by Newton's method; rows are samples. A
  /// constant feature contributes nothing. The result does not depend on the number of threads. Throws ShapeError when
  /// rows and labels differ in number or there are none.
  static Logistic Fit(const Eigen::MatrixXf& features, const Eigen::VectorXf& labels);

  /// Probability in (0, 1). `features` has as many entries as Fit had columns.
  float operator()(const float* features) const;

 private:
  void FitRange(const Eigen::MatrixXf& features);
  void Standardize(const float* features, float* x) const;
  Eigen::VectorXf Expand(const float* features) const;

  Eigen::VectorXf low_, high_;                ///< range to which features are clamped
  Eigen::VectorXf mean_, inverse_deviation_;  ///< mean and inverse deviation of each feature; 0 for a constant one
  Eigen::VectorXf linear_;
  Eigen::MatrixXf quadratic_;  ///< upper triangle
  float constant_ = 0;
};

}  // namespace oraclegs
