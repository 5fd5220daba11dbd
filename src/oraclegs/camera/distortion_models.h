#pragma once
// Projection with distortion: the one function behind all eleven camera models. A ray (x, y, 1) at distance r from the
// axis first moves to distance m(r): r itself (the models built on a pinhole), atan r (the fisheye models) or the FOV
// model's arctangent. The result (a, b), with s = a^2 + b^2, then goes through a radial factor, tangential and
// thin-prism terms:
//   R = (1 + n1 s + n2 s^2 + n3 s^3 + n4 s^4) / (1 + d1 s + d2 s^2 + d3 s^3)
//   u = a R + 2 p1 a b + p2 (s + 2 a^2) + sx s,   v = b R + 2 p2 a b + p1 (s + 2 b^2) + sy s
// [Brown 1966]; [Devernay 2001] (FOV); [Kannala 2006] (fisheye); [Weng 1992] (thin prism).

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <optional>

#include "oraclegs/camera/intrinsics.h"

namespace oraclegs {

/// Intrinsics made ready to map many rays. Radial factors that turn back (m R is not monotone) end at the turning
/// point, so that no two rays share a pixel.
class DistortionMap {
 public:
  explicit DistortionMap(const Intrinsics& intrinsics);

  /// Pixel of the ray (x, y, 1); false when the camera cannot see it.
  bool Project(double x, double y, double* px, double* py) const;
  /// True when the ray falls into the image, its edges included.
  bool Sees(double x, double y) const;
  /// Ray of a pixel; nullopt when no ray falls on it.
  std::optional<Eigen::Vector2d> Unproject(double px, double py) const;

  /// Radians from the axis at which a fisheye model ends: where it turns back, else pi. 0 for the other models.
  double EndOfFisheye() const { return curve_ == Curve::kArcTangent ? std::sqrt(wide_limit_) : 0; }
  /// Pixel of a direction (not zero), of a fisheye model: also of those 90 degrees and more from the axis.
  bool ProjectDirection(const Eigen::Vector3d& direction, double* px, double* py) const;
  /// Direction of a pixel of a fisheye model, of length 1; nullopt when none falls on it.
  std::optional<Eigen::Vector3d> UnprojectDirection(double px, double py) const;

 private:
  enum class Curve { kIdentity, kArcTangent, kFieldOfView };

  struct Radial {
    double factor, derivative;  ///< R and dR/ds
  };
  /// (u, v) at (a, b) and its derivatives.
  struct Distorted {
    double u, v, du_da, du_db, dv_da, dv_db;
    double Determinant() const { return du_da * dv_db - du_db * dv_da; }
  };

  bool ToPixel(double a, double b, double s, double* px, double* py) const;  ///< of a ray that was moved to (a, b)
  double CurveScale(double r2) const;                                        ///< m(r) / r
  double CurveInverse(double m) const;                                       ///< r / m(r)
  Radial RadialAt(double s) const;
  Distorted DistortedAt(double a, double b) const;
  /// The inverses, below the limit of s.
  std::optional<double> InverseRadial(double wanted, double limit) const;
  std::optional<Eigen::Vector2d> InverseDistortion(const Eigen::Vector2d& uv, double start, double limit) const;
  std::optional<Eigen::Vector2d> FromPixel(double px, double py, double limit) const;  ///< (a, b)

  Curve curve_ = Curve::kIdentity;
  int width_, height_;
  double fx_, fy_, cx_, cy_;
  double omega_ = 0;           ///< parameter of the FOV model
  double tan_omega_ = 0;       ///< 2 tan(omega / 2)
  std::array<double, 4> n_{};  ///< numerator of R
  std::array<double, 3> d_{};  ///< denominator of R
  double p1_ = 0, p2_ = 0, sx_ = 0, sy_ = 0;
  bool has_radial_ = false, has_denominator_ = false, has_tangential_ = false;
  double limit_ = 0;       ///< s of a ray that is seen is below this
  double wide_limit_ = 0;  ///< that of a direction
};

/// Pixel of the ray (x, y, 1), in pixels from the top-left corner; nullopt where the camera cannot see the ray.
std::optional<Eigen::Vector2d> Project(const Intrinsics& intrinsics, double x, double y);

/// The inverse, by the model's own formula or Newton's method; nullopt when it does not converge.
std::optional<Eigen::Vector2d> Unproject(const Intrinsics& intrinsics, double px, double py);

}  // namespace oraclegs
