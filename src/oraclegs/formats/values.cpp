#include "oraclegs/formats/values.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/gaussians/damaged_rows.h"

namespace oraclegs {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied as the machine stores them");

constexpr float kFarthestLogit = 15;  // what LeaveOutDamaged takes for an infinite one
constexpr float kLeastDeviation = 1e-30f, kLeastLogScale = -69.07755f, kMostLogScale = 88.7f;

/// Which of x (1), y (2), z (4) a spherical harmonic is odd in, in the order of docs/method.md#spherical-harmonics.
constexpr unsigned kOddAxes[kShCoefficients] = {0, 2, 4, 1, 3, 6, 0, 5, 0, 2, 7, 2, 4, 1, 4, 1};

float SignOf(unsigned odd, unsigned axes) { return std::popcount(odd & axes) % 2 == 1 ? -1.f : 1.f; }

}  // namespace

uint8_t NearestByte(float value) {
  return value > 0 ? static_cast<uint8_t>(std::lround(std::min(value, 255.f))) : uint8_t{0};
}

std::string MarkBytes(const std::vector<float>& marks, float most) {
  std::string bytes;
  for (const float mark : marks) bytes.push_back(static_cast<char>(NearestByte(255 * mark / most)));
  return bytes;
}

float LogitOfOpacity(float opacity) {
  if (std::isnan(opacity)) return opacity;
  return std::clamp(std::log(opacity / (1 - opacity)), -kFarthestLogit, kFarthestLogit);
}

float DeviationOf(float log_scale) { return std::exp(std::clamp(log_scale, kLeastLogScale, kMostLogScale)); }

float LogOfDeviation(float deviation) {
  // A NaN and a negative number become a NaN, which the caller leaves out.
  return std::log(deviation >= 0 ? std::max(deviation, kLeastDeviation) : NAN);
}

std::array<float, 4> UnitQuaternion(const float* wxyz) {
  const float largest = std::max({std::abs(wxyz[0]), std::abs(wxyz[1]), std::abs(wxyz[2]), std::abs(wxyz[3])});
  if (!(largest > 0) || std::isinf(largest)) return {1, 0, 0, 0};
  std::array<float, 4> q;
  float squares = 0;
  for (int i = 0; i < 4; ++i) {
    q[i] = wxyz[i] / largest;  // squares of very small or large numbers would leave the range of a float
    squares += q[i] * q[i];
  }
  for (float& c : q) c /= std::sqrt(squares);
  return q;
}

SmallestThree DropLargest(const std::array<float, 4>& unit) {
  SmallestThree rotation;
  for (int i = 1; i < 4; ++i) {
    if (std::abs(unit[i]) > std::abs(unit[rotation.largest])) rotation.largest = i;
  }
  const float sign = unit[rotation.largest] < 0 ? -1.f : 1.f;
  for (int i = 0, k = 0; i < 4; ++i) {
    if (i != rotation.largest) rotation.others[k++] = sign * unit[i];
  }
  return rotation;
}

std::array<float, 4> RestoreLargest(const SmallestThree& rotation) {
  std::array<float, 4> q{};
  float rest = 1;
  for (int i = 0, k = 0; i < 4; ++i) {
    if (i == rotation.largest) continue;
    q[i] = rotation.others[k++];
    rest -= q[i] * q[i];
  }
  q[rotation.largest] = std::sqrt(std::max(rest, 0.f));
  return UnitQuaternion(q.data());
}

void TurnHalf(const GaussianRows& gaussian, unsigned axes) {
  // F R F for the half turn F: its columns may change sign freely, since a Gaussian is symmetric about its axes.
  for (unsigned i = 0; i < 3; ++i) {
    gaussian.means[i] *= SignOf(1u << i, axes);
    gaussian.quats[1 + i] *= SignOf(1u << i, axes);
  }
  for (int k = 1; k < kShCoefficients; ++k) {
    for (int c = 0; c < 3; ++c) gaussian.sh[3 * k + c] *= SignOf(kOddAxes[k], axes);
  }
}

Gaussians HostCopy(const Gaussians& from, int degree) {
  Gaussians copy = from.To(kCpu).Clone();
  const int used = 3 * ShCount(degree);
  if (used == kShFloats) return copy;
  float* sh = copy.sh.data();
  ParallelBlocks(copy.size(), kSplatGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) std::fill_n(sh + i * kShFloats + used, kShFloats - used, 0.f);
  });
  return copy;
}

GaussianPly ZeroSplat(int64_t n, int sh_degree, const std::string& file) {
  if (n <= 0) throw InputError("{}: holds no Gaussians; export it again", file);
  GaussianPly splat;
  splat.gaussians = Gaussians::Zeros(n);
  splat.sh_degree = sh_degree;
  return splat;
}

GaussianPly WithoutDamaged(GaussianPly splat, const std::string& file) {
  LeaveOutDamaged(file, &splat.gaussians, &splat.marks, &splat.warnings);
  return splat;
}

}  // namespace oraclegs
