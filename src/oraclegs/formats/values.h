#pragma once
// Conversions that the formats have in common: numbers as bytes, opacities, quaternions, axes.

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "oraclegs/gaussians/gaussian_rows.h"
#include "oraclegs/gaussians/ply.h"

namespace oraclegs {

inline constexpr int64_t kSplatGrain = 4096;  ///< Gaussians a task

/// The nearest of the bytes 0..255; 0 for a NaN.
uint8_t NearestByte(float value);

/// Numbers of Gaussians, a byte each: 255 for `most` and what is larger.
std::string MarkBytes(const std::vector<float>& marks, float most);

/// The logit of an opacity in [0,1]; +-15 where it would be infinite.
float LogitOfOpacity(float opacity);

/// A standard deviation from its logarithm, and back: from 1e-30, below which nothing is seen, to the largest float.
float DeviationOf(float log_scale);
float LogOfDeviation(float deviation);

/// Where colors of codes with a step for each part of their range end: what lies outside is cut.
inline constexpr float kLowestColor = -8, kHighestColor = 9;
/// Where view-dependent coefficients of such codes end, on either side of 0.
inline constexpr float kLargestHarmonic = 4;

/// w,x,y,z of length 1; the identity for a quaternion without a direction.
std::array<float, 4> UnitQuaternion(const float* wxyz);

/// A unit quaternion without its largest component, whose sign is made positive.
struct SmallestThree {
  int largest = 0;              ///< its place
  std::array<float, 3> others;  ///< in order, each in [-sqrt(1/2), sqrt(1/2)]
};
SmallestThree DropLargest(const std::array<float, 4>& unit);
/// The reverse; the largest component follows from the length of 1.
std::array<float, 4> RestoreLargest(const SmallestThree& rotation);

/// Axes whose sign changes, added up: two of them, so that it is a half turn.
inline constexpr unsigned kTurnAboutX = 2 | 4;  ///< x right, y down, z forward <-> x right, y up, z back
inline constexpr unsigned kTurnAboutZ = 1 | 2;  ///< x right, y down, z forward <-> x left, y up, z forward

/// Turns one Gaussian by half a turn about an axis through the origin: means, quaternion and all spherical harmonics.
/// Exact, and its own inverse.
void TurnHalf(const GaussianRows& gaussian, unsigned axes);

/// Copies with zeros where the coefficients of `from` lie above `degree`; on the host.
Gaussians HostCopy(const Gaussians& from, int degree);

/// n Gaussians, all zero. Throws InputError naming `file` for n of 0.
GaussianPly ZeroSplat(int64_t n, int sh_degree, const std::string& file);

/// The last step of every decoder, behind its arithmetic: LeaveOutDamaged (gaussians/damaged_rows.h) for a whole file.
GaussianPly WithoutDamaged(GaussianPly splat, const std::string& file);

/// A number of type T at an offset, little-endian. The caller has compared the offset with the size.
template <class T>
T LoadLittle(std::string_view bytes, size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}
template <class T>
void StoreLittle(char* to, T value) {
  std::memcpy(to, &value, sizeof(T));
}

}  // namespace oraclegs
