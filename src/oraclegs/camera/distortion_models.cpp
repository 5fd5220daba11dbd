#include "oraclegs/camera/distortion_models.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace oraclegs {
namespace {

constexpr double kHalfPi = 1.57079632679489661923;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMaxSquaredRadius =
    1e12;                              // squared distance beyond which no turning point is looked for: 89.9999 degrees
constexpr double kSmallAngle2 = 1e-8;  // below it two terms of the arctangent's series are exact in double precision
constexpr int kMaxNewtonSteps = 100, kMaxStepHalvings = 30;  // of Newton's method: steps, and times that one is halved
constexpr double kMaxResidual = 1e-12;  // of Newton's method, in focal lengths: 1e-8 pixels at most

/// Coefficients, lowest power first.
using Polynomial = std::vector<double>;

double Evaluate(const Polynomial& c, double x) {
  double value = 0;
  for (size_t i = c.size(); i-- > 0;) value = value * x + c[i];
  return value;
}

Polynomial Derivative(const Polynomial& c) {
  Polynomial d;
  for (size_t i = 1; i < c.size(); ++i) d.push_back(static_cast<double>(i) * c[i]);
  return d;
}

Polynomial Product(const Polynomial& a, const Polynomial& b) {
  Polynomial product(a.size() + b.size() - 1, 0.);
  for (size_t i = 0; i < a.size(); ++i) {
    for (size_t j = 0; j < b.size(); ++j) product[i + j] += a[i] * b[j];
  }
  return product;
}

double Bisect(const Polynomial& c, double low, double high) {
  const bool low_is_negative = Evaluate(c, low) < 0;
  while (true) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) return low;
    ((Evaluate(c, middle) < 0) == low_is_negative ? low : high) = middle;
  }
}

/// Places in (0, kMaxSquaredRadius) where the polynomial changes sign, ascending. Between two turning points, which are
/// the derivative's changes of sign, there is at most one.
std::vector<double> SignChanges(const Polynomial& c) {
  if (c.size() < 2) return {};
  std::vector<double> places;
  double low = 0;
  std::vector<double> ends = SignChanges(Derivative(c));
  ends.push_back(kMaxSquaredRadius);
  for (const double high : ends) {
    if ((Evaluate(c, low) < 0) != (Evaluate(c, high) < 0)) places.push_back(Bisect(c, low, high));
    low = high;
  }
  return places;
}

double FirstSignChange(const Polynomial& c) {
  if (std::none_of(c.begin(), c.end(), [](double x) { return x < 0; })) return kInfinity;
  const std::vector<double> places = SignChanges(c);
  return places.empty() ? kInfinity : places.front();
}

/// s where sqrt(s) N(s) / D(s) stops growing, or where D reaches zero.
double TurningPoint(const Polynomial& n, const Polynomial& d) {
  // d/dr of r N(r^2) / D(r^2), times D^2: (N + 2 s N') D - 2 s N D'
  const Polynomial two_s{0, 2};
  Polynomial derivative = Product(n, d);
  const auto add = [&derivative](const Polynomial& term, double sign) {
    derivative.resize(std::max(derivative.size(), term.size()), 0.);
    for (size_t i = 0; i < term.size(); ++i) derivative[i] += sign * term[i];
  };
  add(Product(two_s, Product(Derivative(n), d)), 1);
  add(Product(two_s, Product(n, Derivative(d))), -1);
  return std::min(FirstSignChange(derivative), FirstSignChange(d));
}

}  // namespace

DistortionMap::DistortionMap(const Intrinsics& intrinsics)
    : width_(intrinsics.width),
      height_(intrinsics.height),
      fx_(intrinsics.fx()),
      fy_(intrinsics.fy()),
      cx_(intrinsics.cx()),
      cy_(intrinsics.cy()) {
  const auto& p = intrinsics.params;
  switch (intrinsics.model) {
    case CameraModel::kSimplePinhole:
    case CameraModel::kPinhole:
      break;
    case CameraModel::kSimpleRadialFisheye:
      curve_ = Curve::kArcTangent;
      [[fallthrough]];
    case CameraModel::kSimpleRadial:
      n_ = {p[3]};
      break;
    case CameraModel::kRadialFisheye:
      curve_ = Curve::kArcTangent;
      [[fallthrough]];
    case CameraModel::kRadial:
      n_ = {p[3], p[4]};
      break;
    case CameraModel::kOpenCvFisheye:
      curve_ = Curve::kArcTangent;
      n_ = {p[4], p[5], p[6], p[7]};
      break;
    case CameraModel::kOpenCv:
      n_ = {p[4], p[5]};
      p1_ = p[6], p2_ = p[7];
      break;
    case CameraModel::kFullOpenCv:
      n_ = {p[4], p[5], p[8]};
      d_ = {p[9], p[10], p[11]};
      p1_ = p[6], p2_ = p[7];
      break;
    case CameraModel::kThinPrismFisheye:
      curve_ = Curve::kArcTangent;
      n_ = {p[4], p[5], p[8], p[9]};
      p1_ = p[6], p2_ = p[7];
      sx_ = p[10], sy_ = p[11];
      break;
    case CameraModel::kFov:
      omega_ = std::abs(p[4]);  // the formula is even in it
      tan_omega_ = 2 * std::tan(omega_ / 2);
      if (omega_ > 0) curve_ = Curve::kFieldOfView;
      break;
  }
  const auto nonzero = [](double x) { return x != 0; };
  has_denominator_ = std::any_of(d_.begin(), d_.end(), nonzero);
  has_radial_ = has_denominator_ || std::any_of(n_.begin(), n_.end(), nonzero);
  has_tangential_ = p1_ != 0 || p2_ != 0 || sx_ != 0 || sy_ != 0;
  limit_ = has_radial_ ? TurningPoint({1, n_[0], n_[1], n_[2], n_[3]}, {1, d_[0], d_[1], d_[2]}) : kInfinity;
  wide_limit_ = std::min(limit_, 4 * kHalfPi * kHalfPi);
  if (curve_ == Curve::kArcTangent) limit_ = std::min(limit_, kHalfPi * kHalfPi);
  if (curve_ == Curve::kFieldOfView) {
    limit_ = omega_ < 2 * kHalfPi ? kHalfPi * kHalfPi / (omega_ * omega_) : 0;  // a wider camera sees behind itself
  }
}

inline double DistortionMap::CurveScale(double r2) const {
  if (curve_ == Curve::kIdentity) return 1;
  const double z2 = curve_ == Curve::kFieldOfView ? r2 * tan_omega_ * tan_omega_ : r2;
  const double z = std::sqrt(z2);
  const double scale = z2 < kSmallAngle2 ? 1 - z2 / 3 : std::atan(z) / z;
  return curve_ == Curve::kFieldOfView ? scale * tan_omega_ / omega_ : scale;
}

double DistortionMap::CurveInverse(double m) const {
  if (curve_ == Curve::kIdentity) return 1;
  const double angle = curve_ == Curve::kFieldOfView ? m * omega_ : m;
  const double scale = angle * angle < kSmallAngle2 ? 1 + angle * angle / 3 : std::tan(angle) / angle;
  return curve_ == Curve::kFieldOfView ? scale * omega_ / tan_omega_ : scale;
}

inline DistortionMap::Radial DistortionMap::RadialAt(double s) const {
  const double numerator = 1 + s * (n_[0] + s * (n_[1] + s * (n_[2] + s * n_[3])));
  const double derivative = n_[0] + s * (2 * n_[1] + s * (3 * n_[2] + s * 4 * n_[3]));
  if (!has_denominator_) return {numerator, derivative};
  const double inverse = 1 / (1 + s * (d_[0] + s * (d_[1] + s * d_[2])));
  const double denominator_derivative = d_[0] + s * (2 * d_[1] + s * 3 * d_[2]);
  const double factor = numerator * inverse;
  return {factor, (derivative - factor * denominator_derivative) * inverse};
}

inline DistortionMap::Distorted DistortionMap::DistortedAt(double a, double b) const {
  const double s = a * a + b * b;
  const Radial radial = RadialAt(s);
  Distorted distorted;
  distorted.u = a * radial.factor + 2 * p1_ * a * b + p2_ * (s + 2 * a * a) + sx_ * s;
  distorted.v = b * radial.factor + 2 * p2_ * a * b + p1_ * (s + 2 * b * b) + sy_ * s;
  const double mixed = 2 * a * b * radial.derivative + 2 * p1_ * a + 2 * p2_ * b;
  distorted.du_da = radial.factor + 2 * a * a * radial.derivative + 2 * p1_ * b + 6 * p2_ * a + 2 * sx_ * a;
  distorted.du_db = mixed + 2 * sx_ * b;
  distorted.dv_da = mixed + 2 * sy_ * a;
  distorted.dv_db = radial.factor + 2 * b * b * radial.derivative + 2 * p2_ * a + 6 * p1_ * b + 2 * sy_ * b;
  return distorted;
}

bool DistortionMap::Project(double x, double y, double* px, double* py) const {
  const double r2 = x * x + y * y;
  const double scale = CurveScale(r2);
  const double s = r2 * scale * scale;
  return s < limit_ && ToPixel(x * scale, y * scale, s, px, py);
}

inline bool DistortionMap::ToPixel(double a, double b, double s, double* px, double* py) const {
  double u = a, v = b;
  if (has_tangential_) {
    const Distorted distorted = DistortedAt(a, b);
    if (!(distorted.Determinant() > 0)) return false;  // here the image is folded back over itself
    u = distorted.u;
    v = distorted.v;
  } else if (has_radial_) {
    const double radial = RadialAt(s).factor;
    u *= radial;
    v *= radial;
  }
  *px = fx_ * u + cx_;
  *py = fy_ * v + cy_;
  return std::isfinite(*px) && std::isfinite(*py);
}

bool DistortionMap::Sees(double x, double y) const {
  double px = 0, py = 0;
  return Project(x, y, &px, &py) && px >= 0 && px <= width_ && py >= 0 && py <= height_;
}

bool DistortionMap::ProjectDirection(const Eigen::Vector3d& direction, double* px, double* py) const {
  const double across = std::hypot(direction.x(), direction.y()), angle = std::atan2(across, direction.z());
  const double scale = across > 0 ? angle / across : 0, s = angle * angle;
  return curve_ == Curve::kArcTangent && s < wide_limit_ &&
         ToPixel(direction.x() * scale, direction.y() * scale, s, px, py);
}

/// m with m R(m^2) = wanted, by Newton's method inside a bracket that halves when a step leaves it.
std::optional<double> DistortionMap::InverseRadial(double wanted, double limit) const {
  const auto value = [this](double m) { return m * RadialAt(m * m).factor; };
  const double end = std::sqrt(std::min(limit, kMaxSquaredRadius));
  if (!has_radial_) return wanted < end ? std::optional(wanted) : std::nullopt;
  double low = 0, high = std::min(end, std::max(wanted, 1e-3));
  while (value(high) < wanted && high < end) high = std::min(2 * high, end);
  if (!(value(high) >= wanted)) return std::nullopt;
  double m = std::min(wanted, high);
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    const Radial radial = RadialAt(m * m);
    const double error = m * radial.factor - wanted;
    if (error == 0) return m;
    (error < 0 ? low : high) = m;
    double next = m - error / (radial.factor + 2 * m * m * radial.derivative);
    if (!(next > low && next < high)) next = low + (high - low) / 2;
    if (next <= low || next >= high || next == m) return m;
    m = next;
  }
  return m;
}

/// (a, b) that distorts to uv, by Newton's method with steps cut until the error falls; `start` is the radial solution.
std::optional<Eigen::Vector2d> DistortionMap::InverseDistortion(const Eigen::Vector2d& uv, double start,
                                                                double limit) const {
  const double length = uv.norm();
  Eigen::Vector2d ab = length > 0 ? Eigen::Vector2d(uv * (start / length)) : Eigen::Vector2d::Zero();
  Distorted distorted = DistortedAt(ab.x(), ab.y());
  const auto error_of = [&uv](const Distorted& at) { return Eigen::Vector2d(at.u - uv.x(), at.v - uv.y()); };
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    const Eigen::Vector2d error = error_of(distorted);
    const double determinant = distorted.Determinant();
    if (error.norm() <= kMaxResidual * (1 + length) || !(determinant > 0)) break;
    const Eigen::Vector2d move((distorted.dv_db * error.x() - distorted.du_db * error.y()) / determinant,
                               (distorted.du_da * error.y() - distorted.dv_da * error.x()) / determinant);
    double cut = 1;
    Eigen::Vector2d next = ab;
    for (int i = 0; i < kMaxStepHalvings; ++i, cut /= 2) {
      next = ab - cut * move;
      if (!(next.squaredNorm() < limit)) continue;
      distorted = DistortedAt(next.x(), next.y());
      if (error_of(distorted).norm() < error.norm() && distorted.Determinant() > 0) break;
    }
    if (next == ab) break;
    ab = next;
  }
  distorted = DistortedAt(ab.x(), ab.y());
  const bool found = error_of(distorted).norm() <= 100 * kMaxResidual * (1 + length) && ab.squaredNorm() < limit &&
                     distorted.Determinant() > 0;
  return found ? std::optional(ab) : std::nullopt;
}

std::optional<Eigen::Vector2d> DistortionMap::FromPixel(double px, double py, double limit) const {
  const Eigen::Vector2d uv((px - cx_) / fx_, (py - cy_) / fy_);
  const double length = uv.norm();
  if (!std::isfinite(length)) return std::nullopt;
  const std::optional<double> radial = InverseRadial(length, limit);
  Eigen::Vector2d ab = uv;
  if (has_tangential_) {
    // Tangential terms reach pixels a little beyond the end of the radial part.
    const double start = radial.value_or(0.9 * std::sqrt(std::min(limit, kMaxSquaredRadius)));
    const auto inverse = InverseDistortion(uv, start, limit);
    if (!inverse) return std::nullopt;
    ab = *inverse;
  } else {
    if (!radial || !(*radial * *radial < limit)) return std::nullopt;
    if (length > 0) ab = uv * (*radial / length);
  }
  return ab;
}

std::optional<Eigen::Vector3d> DistortionMap::UnprojectDirection(double px, double py) const {
  const auto ab = curve_ == Curve::kArcTangent ? FromPixel(px, py, wide_limit_) : std::nullopt;
  if (!ab) return std::nullopt;
  const double angle = ab->norm(), scale = angle > 0 ? std::sin(angle) / angle : 1;
  return Eigen::Vector3d(ab->x() * scale, ab->y() * scale, std::cos(angle));
}

std::optional<Eigen::Vector2d> DistortionMap::Unproject(double px, double py) const {
  const auto ab = FromPixel(px, py, limit_);
  if (!ab) return std::nullopt;
  const Eigen::Vector2d ray = *ab * CurveInverse(ab->norm());
  return ray.allFinite() ? std::optional(ray) : std::nullopt;
}

std::optional<Eigen::Vector2d> Project(const Intrinsics& intrinsics, double x, double y) {
  Eigen::Vector2d pixel;
  if (!DistortionMap(intrinsics).Project(x, y, &pixel.x(), &pixel.y())) return std::nullopt;
  return pixel;
}

std::optional<Eigen::Vector2d> Unproject(const Intrinsics& intrinsics, double px, double py) {
  return DistortionMap(intrinsics).Unproject(px, py);
}

}  // namespace oraclegs
