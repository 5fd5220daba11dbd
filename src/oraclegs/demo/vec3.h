#pragma once
// Three doubles with a fixed order of operations. Eigen may reorder a sum from one version to the next, and the demo
// scene promises the same bytes on every machine; functions here that replace libm's keep that promise, too.

#include <cmath>

namespace oraclegs {

struct Vec3 {
  double x = 0, y = 0, z = 0;
};

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(const Vec3& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
inline Vec3 operator*(double s, const Vec3& a) { return a * s; }
inline Vec3 operator*(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline double Dot(const Vec3& a, const Vec3& b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }
inline Vec3 Cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double Length(const Vec3& a) { return std::sqrt(Dot(a, a)); }
inline Vec3 Normalized(const Vec3& a) { return a * (1 / Length(a)); }
inline Vec3 Mix(const Vec3& a, const Vec3& b, double t) { return a + (b - a) * t; }
inline double Mix(double a, double b, double t) { return a + (b - a) * t; }
inline double Clamp01(double v) { return v < 0 ? 0 : (v > 1 ? 1 : v); }
/// 0 below a, 1 above b, smooth between.
inline double Smoothstep(double a, double b, double v) {
  const double t = Clamp01((v - a) / (b - a));
  return t * t * (3 - 2 * t);
}

struct SinCos {
  double sin, cos;
};

/// Sine and cosine of `turns` full turns, to 1e-14, from the four basic operations alone.
inline SinCos SinCosOfTurns(double turns) {
  const double quarters = 4 * turns;
  const double nearest = std::floor(quarters + 0.5);
  const double a = (quarters - nearest) * 1.57079632679489661923;  // |a| <= pi/4
  const double a2 = a * a;
  double s = 1, c = 1;
  for (int k = 8; k >= 1; --k) {  // the Taylor series, innermost term first
    s = 1 - s * a2 / ((2 * k) * (2 * k + 1));
    c = 1 - c * a2 / ((2 * k - 1) * (2 * k));
  }
  s *= a;
  switch (static_cast<int>(nearest - 4 * std::floor(nearest / 4))) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

}  // namespace oraclegs
