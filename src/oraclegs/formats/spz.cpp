#include "oraclegs/formats/codecs.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/formats/spz_container.h"

namespace oraclegs {
namespace {

constexpr int kPositionBytes = 3;
constexpr float kLargestFixed = (1 << 23) - 1;
constexpr float kStepsPerDeviation = 16;  // of positions
constexpr int kSpareBits = 3;             // positions may lose: then they are exact to a quarter of a deviation
constexpr int64_t kFarShare = 100;        // one Gaussian in so many may stop at the border for the sake of the others
constexpr float kSpzColorScale = 0.15f;   // of the constant harmonic
constexpr float kScaleSteps = 16, kScaleOffset = 10;
constexpr int kSmallestBits = 9;  // of a component, besides its sign
constexpr float kSmallestMax = 511;
constexpr float kSqrtHalf = 0.70710678f;
constexpr float kShSteps = 128;
constexpr int kOpaqueBucket = 4, kMiddleBucket = 8, kFaintBucket = 16;  // in steps of 1/128
constexpr float kOpaque = 0.25f, kMiddle = 0.08f;                       // opacities

/// Bits after the point with which 24 bits hold a coordinate.
int FittingBits(float largest) {
  if (!(largest > 0)) return kMaxFractionalBits;
  return static_cast<int>(std::clamp(std::floor(std::log2(kLargestFixed / largest)), 0.f, float{kMaxFractionalBits}));
}

/// Bits after the point that positions get: few, since every bit is noise that does not compress.
int FractionalBits(const Gaussians& gaussians) {
  const auto n = static_cast<size_t>(gaussians.size());
  std::vector<float> middle(n), reach(n);
  for (size_t i = 0; i < n; ++i) {
    const float *s = gaussians.log_scales.data() + 3 * i, *x = gaussians.means.data() + 3 * i;
    middle[i] = std::max(std::min(s[0], s[1]), std::min(std::max(s[0], s[1]), s[2]));
    reach[i] = std::max({std::abs(x[0]), std::abs(x[1]), std::abs(x[2])});
  }
  const float exact = std::ceil(std::log2(kStepsPerDeviation) - Median(&middle) / std::log(2.f));
  const auto wanted = static_cast<int>(std::clamp(exact, 0.f, float{kMaxFractionalBits}));
  const int fitting = FittingBits(*std::max_element(reach.begin(), reach.end()));
  if (fitting >= wanted - kSpareBits) return std::min(wanted, fitting);
  // A few Gaussians far away must not cost all others their place: they stop at the border.
  const auto last = reach.begin() + static_cast<std::ptrdiff_t>(n - 1 - n / kFarShare);
  std::nth_element(reach.begin(), last, reach.end());
  return std::min(wanted, FittingBits(*last));
}

void PackPosition(float value, float steps, char* to) {
  const auto fixed = static_cast<int32_t>(std::lround(std::clamp(value * steps, -kLargestFixed, kLargestFixed)));
  for (int b = 0; b < kPositionBytes; ++b) to[b] = static_cast<char>(fixed >> (8 * b));
}

float UnpackPosition(const char* from, float steps) {
  uint32_t bits = 0;
  for (int b = 0; b < kPositionBytes; ++b) bits |= uint32_t{static_cast<uint8_t>(from[b])} << (8 * (b + 1));
  return static_cast<float>(static_cast<int32_t>(bits) >> 8) / steps;  // the shift keeps the sign
}

/// Quaternions stand as x,y,z,w in the file.
void PackSpzRotation(const float* wxyz, SpzVersion version, char* to) {
  const std::array<float, 4> q = UnitQuaternion(wxyz);
  if (version == SpzVersion::k2) {
    const float sign = q[0] < 0 ? -1.f : 1.f;
    for (int i = 0; i < 3; ++i) to[i] = static_cast<char>(NearestByte(sign * q[i + 1] * 127.5f + 127.5f));
    return;
  }
  const SmallestThree rotation = DropLargest({q[1], q[2], q[3], q[0]});
  auto bits = static_cast<uint32_t>(rotation.largest);
  for (const float c : rotation.others) {
    const float steps = std::min(std::round(std::abs(c) / kSqrtHalf * kSmallestMax), kSmallestMax);
    bits = (bits << (kSmallestBits + 1)) | (c < 0 ? 1u << kSmallestBits : 0u) | static_cast<uint32_t>(steps);
  }
  StoreLittle(to, bits);
}

void UnpackSpzRotation(const char* from, SpzVersion version, float* wxyz) {
  if (version == SpzVersion::k2) {
    float rest = 1;
    for (int i = 0; i < 3; ++i) {
      wxyz[i + 1] = static_cast<float>(static_cast<uint8_t>(from[i])) / 127.5f - 1;
      rest -= wxyz[i + 1] * wxyz[i + 1];
    }
    wxyz[0] = std::sqrt(std::max(rest, 0.f));
    return;
  }
  const auto bits = LoadLittle<uint32_t>({from, 4}, 0);
  SmallestThree rotation{static_cast<int>(bits >> 30), {}};
  for (int i = 0; i < 3; ++i) {
    const uint32_t part = bits >> ((kSmallestBits + 1) * (2 - i));
    const float size = static_cast<float>(part & 511) / kSmallestMax * kSqrtHalf;
    rotation.others[i] = (part >> kSmallestBits & 1) != 0 ? -size : size;
  }
  const std::array<float, 4> xyzw = RestoreLargest(rotation);
  wxyz[0] = xyzw[3];
  std::copy_n(xyzw.data(), 3, wxyz + 1);
}

/// The fainter a Gaussian, the less an error of its view-dependent color is seen, and the fewer values it gets.
int HarmonicBucket(float opacity) {
  if (opacity >= kOpaque) return kOpaqueBucket;
  return opacity >= kMiddle ? kMiddleBucket : kFaintBucket;
}

/// Rounded to a whole bucket: fewer values compress better.
uint8_t PackHarmonic(float value, int bucket) {
  const float steps = std::round(value * kShSteps / static_cast<float>(bucket)) * static_cast<float>(bucket);
  return NearestByte(steps + kShSteps);
}

/// A number of 16 bits: 5 of the exponent, 10 of the fraction.
float FloatOfHalf(uint16_t half) {
  const float sign = half >> 15 != 0 ? -1.f : 1.f;
  const int exponent = half >> 10 & 31, fraction = half & 1023;
  if (exponent == 31) return fraction == 0 ? sign * INFINITY : NAN;
  if (exponent == 0) return sign * std::ldexp(static_cast<float>(fraction), -24);
  return sign * std::ldexp(static_cast<float>(1024 + fraction), exponent - 25);
}

/// A coordinate of the file; version 1 has halves.
float UnpackCoordinate(const char* positions, uint64_t index, const SpzContent& content) {
  if (content.version == 1) return FloatOfHalf(LoadLittle<uint16_t>({positions + 2 * index, 2}, 0));
  return UnpackPosition(positions + kPositionBytes * index, static_cast<float>(1 << content.fractional_bits));
}

}  // namespace

std::string EncodeSpz(const Gaussians& gaussians, int sh_degree, SpzVersion version, bool antialiased) {
  gaussians.Check("EncodeSpz");
  const Gaussians turned = HostCopy(gaussians, sh_degree);
  const int64_t n = turned.size();
  const SpzLayout layout(static_cast<uint64_t>(n), sh_degree, static_cast<uint32_t>(version));
  const int bits = FractionalBits(turned);
  const auto steps = static_cast<float>(1 << bits);
  SpzContent content;
  content.version = static_cast<uint32_t>(version);
  content.count = static_cast<uint32_t>(n);
  content.degree = sh_degree;
  content.fractional_bits = bits;
  content.antialiased = antialiased;
  content.attributes.resize(layout.end);
  char* out = content.attributes.data();
  const GaussianRows rows = turned.Rows();
  ParallelBlocks(n, kSplatGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      const GaussianRows g = rows.From(i);
      TurnHalf(g, kTurnAboutX);
      const auto at = static_cast<uint64_t>(i);
      for (int c = 0; c < 3; ++c) {
        PackPosition(g.means[c], steps, out + (3 * at + c) * kPositionBytes);
        out[layout.colors + 3 * at + c] = static_cast<char>(NearestByte((g.sh[c] * kSpzColorScale + 0.5f) * 255));
        out[layout.scales + 3 * at + c] =
            static_cast<char>(NearestByte((g.log_scales[c] + kScaleOffset) * kScaleSteps));
      }
      const float opacity = Sigmoid(g.opacity_logits[0]);
      const int bucket = HarmonicBucket(opacity);
      out[layout.alphas + at] = static_cast<char>(NearestByte(opacity * 255));
      PackSpzRotation(g.quats, version, out + layout.rotations + layout.rotation_bytes * at);
      char* sh = out + layout.sh + layout.sh_bytes * at;
      for (int k = 0; k < static_cast<int>(layout.sh_bytes); ++k) {
        sh[k] = static_cast<char>(PackHarmonic(g.sh[3 + k], bucket));
      }
    }
  });
  return PackSpz(content);
}

GaussianPly DecodeSpz(std::string_view bytes, const std::string& file) {
  const SpzContent content = UnpackSpz(bytes, file);
  const SpzLayout layout(content.count, content.degree, content.version);
  const auto rotations = content.version <= 2 ? SpzVersion::k2 : SpzVersion::k3;
  GaussianPly splat = ZeroSplat(content.count, std::min(content.degree, kMaxShDegree), file);
  splat.antialiased = content.antialiased;
  if (content.degree > kMaxShDegree) splat.warnings.push_back(DegreeLeftOut(content.degree, file));
  if (content.extended) {
    splat.warnings.push_back(fmt::format(
        "{}: has extensions of SPZ, which are left out; if it looks turned, one of them said which axes it has", file));
  }
  const auto sh_used = static_cast<uint64_t>(3 * (ShCount(splat.sh_degree) - 1));
  const GaussianRows rows = splat.gaussians.Rows();
  const char* in = content.attributes.data();
  const auto byte = [in](uint64_t at) { return static_cast<float>(static_cast<uint8_t>(in[at])); };
  ParallelBlocks(splat.gaussians.size(), kSplatGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      const GaussianRows g = rows.From(i);
      const auto at = static_cast<uint64_t>(i);
      for (int c = 0; c < 3; ++c) {
        g.means[c] = UnpackCoordinate(in, 3 * at + c, content);
        g.sh[c] = (byte(layout.colors + 3 * at + c) / 255 - 0.5f) / kSpzColorScale;
        g.log_scales[c] = byte(layout.scales + 3 * at + c) / kScaleSteps - kScaleOffset;
      }
      g.opacity_logits[0] = LogitOfOpacity(byte(layout.alphas + at) / 255);
      UnpackSpzRotation(in + layout.rotations + layout.rotation_bytes * at, rotations, g.quats);
      const uint64_t sh = layout.sh + layout.sh_bytes * at;
      for (uint64_t k = 0; k < sh_used; ++k) g.sh[3 + k] = (byte(sh + k) - kShSteps) / kShSteps;
      TurnHalf(g, kTurnAboutX);
    }
  });
  return WithoutDamaged(std::move(splat), file);
}

}  // namespace oraclegs
