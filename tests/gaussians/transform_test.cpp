#include "oraclegs/gaussians/transform.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "support/buffers.h"

namespace oraclegs {
namespace {

Eigen::Matrix3d Turn(double angle, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

/// Some harmonics in closed form, of all three degrees; their places among the coefficients.
double Harmonic(int k, const Eigen::Vector3d& d) {
  const double x = d.x(), y = d.y(), z = d.z();
  const double values[] = {1,
                           -0.4886025119 * y,
                           0.4886025119 * z,
                           -0.4886025119 * x,
                           1.0925484306 * x * y,
                           -1.0925484306 * y * z,
                           0.3153915653 * (2 * z * z - x * x - y * y),
                           -1.0925484306 * x * z,
                           0.5462742153 * (x * x - y * y),
                           -0.5900435899 * y * (3 * x * x - y * y),
                           2.8906114426 * x * y * z,
                           -0.4570457995 * y * (4 * z * z - x * x - y * y),
                           0.3731763326 * z * (2 * z * z - 3 * x * x - 3 * y * y),
                           -0.4570457995 * x * (4 * z * z - x * x - y * y),
                           1.4453057213 * z * (x * x - y * y),
                           -0.5900435899 * x * (x * x - 3 * y * y)};
  return values[k];
}

TEST(RotationOfHarmonics, TurnsWhatTheCoefficientsDescribe) {
  const Eigen::Matrix3d rotation = Turn(1.1, {1, -2, 0.5});
  const ShRotation turned = RotationOfHarmonics(rotation);
  const Buffer<float> directions = RandomNormal({20, 3}, 1);
  for (int k = 0; k < kShCoefficients; ++k) {
    for (int64_t i = 0; i < 20; ++i) {
      const Eigen::Vector3d d =
          Eigen::Vector3d(directions[3 * i], directions[3 * i + 1], directions[3 * i + 2]).normalized();
      double after = 0;
      for (int j = 0; j < kShCoefficients; ++j) after += turned(j, k) * Harmonic(j, d);
      EXPECT_NEAR(after, Harmonic(k, rotation.transpose() * d), 1e-5) << "coefficient " << k;
    }
  }
}

TEST(RotationOfHarmonics, IsAGroupAndKeepsLengths) {
  const Eigen::Matrix3d a = Turn(0.7, {0, 1, 3}), b = Turn(-2.2, {1, 1, 0});
  const ShRotation da = RotationOfHarmonics(a), db = RotationOfHarmonics(b);
  EXPECT_LT((RotationOfHarmonics(a * b) - da * db).cwiseAbs().maxCoeff(), 1e-5f);
  EXPECT_LT((da * da.transpose() - ShRotation::Identity()).cwiseAbs().maxCoeff(), 1e-5f);
  EXPECT_LT((RotationOfHarmonics(Eigen::Matrix3d::Identity()) - ShRotation::Identity()).cwiseAbs().maxCoeff(), 1e-6f);
}

TEST(Transformed, MovesMeansScalesAndRotations) {
  Gaussians g = Gaussians::Zeros(1);
  g.means[0] = 1;
  g.quats[0] = 1;
  g.log_scales[1] = 0.5f;
  const Gaussians moved = Transformed(g, {Turn(M_PI / 2, {0, 0, 1}), 2, {0, 0, 5}});
  EXPECT_NEAR(moved.means[0], 0, 1e-6);
  EXPECT_NEAR(moved.means[1], 2, 1e-6);
  EXPECT_NEAR(moved.means[2], 5, 1e-6);
  EXPECT_NEAR(moved.log_scales[1], 0.5f + std::log(2.f), 1e-6);
  EXPECT_NEAR(moved.quats[0], std::sqrt(0.5f), 1e-6);
  EXPECT_NEAR(moved.quats[3], std::sqrt(0.5f), 1e-6);
  EXPECT_EQ(g.means[0], 1);
}

TEST(Transformed, ComesBackByTheInverse) {
  Gaussians g = Gaussians::Empty(50);
  uint64_t seed = 1;
  g.ForEach([&](const char*, Buffer<float>& t) { t = RandomNormal(t.shape(), seed++); });
  const Eigen::Matrix3d r = Turn(2, {3, 1, 1});
  const Gaussians back = Transformed(Transformed(g, {r, 4, {1, 2, 3}}),
                                     {r.transpose(), 0.25, -0.25 * (r.transpose() * Eigen::Vector3d(1, 2, 3))});
  EXPECT_LT((Flat(back.means) - Flat(g.means)).abs().maxCoeff(), 1e-4f);
  EXPECT_LT((Flat(back.quats) - Flat(g.quats)).abs().maxCoeff(), 1e-5f);
  EXPECT_LT((Flat(back.sh) - Flat(g.sh)).abs().maxCoeff(), 1e-4f);
}

}  // namespace
}  // namespace oraclegs
