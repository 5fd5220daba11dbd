#include "oraclegs/gaussians/transform.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr int64_t kTransformGrain = 1024;

/// The matrix of a degree for harmonics without the sign (-1)^m; rows and columns are orders from -degree to degree.
using ShBlock = Eigen::MatrixXd;

double At(const ShBlock& block, int m, int n) {
  const auto degree = static_cast<int>(block.rows() / 2);
  return block(m + degree, n + degree);
}

/// The products of the recursion, in the names of the paper.
struct Recursion {
  const ShBlock& first;  // degree 1
  const ShBlock& below;  // degree l - 1
  int l;

  double P(int i, int m, int n) const {
    if (n == l) return At(first, i, 1) * At(below, m, l - 1) - At(first, i, -1) * At(below, m, 1 - l);
    if (n == -l) return At(first, i, 1) * At(below, m, 1 - l) + At(first, i, -1) * At(below, m, l - 1);
    return At(first, i, 0) * At(below, m, n);
  }
  double V(int m, int n) const {
    if (m == 0) return P(1, 1, n) + P(-1, -1, n);
    if (m == 1) return std::sqrt(2.) * P(1, 0, n);
    if (m == -1) return std::sqrt(2.) * P(-1, 0, n);
    return m > 0 ? P(1, m - 1, n) - P(-1, 1 - m, n) : P(1, m + 1, n) + P(-1, -m - 1, n);
  }
  double W(int m, int n) const { return m > 0 ? P(1, m + 1, n) + P(-1, -m - 1, n) : P(1, m - 1, n) - P(-1, 1 - m, n); }
  double Entry(int m, int n) const {
    const int size = std::abs(m);
    const double zero = m == 0 ? 1 : 0;
    const double divisor = std::abs(n) < l ? (l + n) * (l - n) : 2 * l * (2 * l - 1);
    const double u = std::sqrt((l + m) * (l - m) / divisor);
    const double v = (1 - 2 * zero) / 2 * std::sqrt((1 + zero) * (l + size - 1) * (l + size) / divisor);
    const double w = -(1 - zero) / 2 * std::sqrt((l - size - 1) * (l - size) / divisor);
    // A factor of zero stands before orders that degree l - 1 has not.
    return (u != 0 ? u * P(0, m, n) : 0) + (v != 0 ? v * V(m, n) : 0) + (w != 0 ? w * W(m, n) : 0);
  }
};

}  // namespace

ShRotation RotationOfHarmonics(const Eigen::Matrix3d& rotation) {
  ShRotation all = ShRotation::Zero();
  all(0, 0) = 1;
  ShBlock first(3, 3);
  const int axes[] = {1, 2, 0};  // degree 1 is y, z, x
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) first(i, j) = rotation(axes[i], axes[j]);
  }
  ShBlock block = first;
  for (int l = 1; l <= kMaxShDegree; ++l) {
    if (l > 1) {
      ShBlock next(2 * l + 1, 2 * l + 1);
      const Recursion recursion{first, block, l};
      for (int m = -l; m <= l; ++m) {
        for (int n = -l; n <= l; ++n) next(m + l, n + l) = recursion.Entry(m, n);
      }
      block = next;
    }
    for (int m = -l; m <= l; ++m) {
      for (int n = -l; n <= l; ++n) {
        const double sign = (m + n) % 2 == 0 ? 1 : -1;  // ours have the sign (-1)^m
        all(l * l + l + m, l * l + l + n) = static_cast<float>(sign * At(block, m, n));
      }
    }
  }
  return all;
}

Gaussians Transformed(const Gaussians& gaussians, const Similarity& transform) {
  gaussians.Check("Transformed");
  Gaussians moved = gaussians.To(kCpu).Clone();
  const bool turns = !transform.rotation.isIdentity(0);
  const ShRotation harmonics = RotationOfHarmonics(transform.rotation);
  const Eigen::Quaternionf turn(Eigen::Quaterniond(transform.rotation).cast<float>());
  const auto log_scale = static_cast<float>(std::log(transform.scale));
  const GaussianRows all = moved.Rows();
  ParallelBlocks(moved.size(), kTransformGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      const GaussianRows g = all.From(i);
      Eigen::Map<Eigen::Vector3f> mean(g.means);
      mean = (transform.scale * (transform.rotation * mean.cast<double>()) + transform.translation).cast<float>();
      for (int c = 0; c < 3; ++c) g.log_scales[c] += log_scale;
      if (!turns) continue;  // rounding would change harmonics that stay
      const Eigen::Quaternionf q = turn * Eigen::Quaternionf(g.quats[0], g.quats[1], g.quats[2], g.quats[3]);
      g.quats[0] = q.w();
      g.quats[1] = q.x();
      g.quats[2] = q.y();
      g.quats[3] = q.z();
      Eigen::Map<Eigen::Matrix<float, kShCoefficients, 3, Eigen::RowMajor>> sh(g.sh);
      sh = (harmonics * sh).eval();
    }
  });
  return moved;
}

}  // namespace oraclegs
