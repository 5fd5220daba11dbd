#include "oraclegs/formats/spz.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"
#include "oraclegs/formats/gzip.h"

namespace oraclegs {
namespace {

constexpr uint32_t kSpzMagic = 0x5053474e;  // "NGSP"
constexpr size_t kSpzHeader = 16;
constexpr int kPositionBytes = 3;
constexpr int kUsualFractionalBits = 12;  // of Niantic's own encoder: coordinates up to 2048
constexpr int kMaxFractionalBits = 23;
constexpr float kLargestFixed = (1 << 23) - 1;
constexpr float kStepsPerDeviation = 16;  // of positions
constexpr float kSpzColorScale = 0.15f;   // of the constant harmonic
constexpr float kScaleSteps = 16, kScaleOffset = 10;
constexpr int kSmallestBits = 9;  // of a component, besides its sign
constexpr float kSmallestMax = 511;
constexpr float kSqrtHalf = 0.70710678f;
constexpr float kShSteps = 128;
constexpr int kOpaqueBucket = 4, kMiddleBucket = 8, kFaintBucket = 16;  // in steps of 1/128
constexpr float kOpaque = 0.25f, kMiddle = 0.08f;                       // opacities

// Gzip packs equal bytes a thousandfold, but the positions of a scene are mostly noise.
constexpr uint64_t kSpzPlausibleBytes = 4 << 20, kSpzMostPerByte = 200;

/// Where each attribute begins, for n Gaussians.
struct SpzLayout {
  SpzLayout(uint64_t n, int degree, SpzVersion version)
      : rotation_bytes(version == SpzVersion::k2 ? 3 : 4), sh_bytes(3 * (ShCount(degree) - 1)) {
    alphas = kSpzHeader + n * 3 * kPositionBytes;
    colors = alphas + n;
    scales = colors + 3 * n;
    rotations = scales + 3 * n;
    sh = rotations + rotation_bytes * n;
    end = sh + sh_bytes * n;
  }

  uint64_t rotation_bytes, sh_bytes;  // of one Gaussian
  uint64_t alphas, colors, scales, rotations, sh, end;
};

/// Bits after the point that positions get: few, since every bit is noise that does not compress.
int FractionalBits(const Gaussians& gaussians) {
  float largest = 0;
  for (const float x : gaussians.means.span()) largest = std::max(largest, std::abs(x));
  std::vector<float> middle;
  for (int64_t i = 0; i < gaussians.size(); ++i) {
    const float* s = gaussians.log_scales.data() + 3 * i;
    middle.push_back(std::max(std::min(s[0], s[1]), std::min(std::max(s[0], s[1]), s[2])));
  }
  const float wanted = std::log2(kStepsPerDeviation) - Median(&middle) / std::log(2.f);
  const float fitting = largest > 0 ? std::floor(std::log2(kLargestFixed / largest)) : kMaxFractionalBits;
  const auto bits = static_cast<int>(std::clamp(std::ceil(wanted), 0.f, float{kMaxFractionalBits}));
  // A few Gaussians far away must not cost all others their place: they stop at the border.
  return std::min(bits, std::max(static_cast<int>(fitting), kUsualFractionalBits));
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

/// The fainter a Gaussian, the less an error of its view-dependent colour is seen, and the fewer values it gets.
int HarmonicBucket(float opacity) {
  if (opacity >= kOpaque) return kOpaqueBucket;
  return opacity >= kMiddle ? kMiddleBucket : kFaintBucket;
}

/// Rounded to a whole bucket: fewer values compress better.
uint8_t PackHarmonic(float value, int bucket) {
  const float steps = std::round(value * kShSteps / static_cast<float>(bucket)) * static_cast<float>(bucket);
  return NearestByte(steps + kShSteps);
}

SpzVersion CheckSpzHeader(std::string_view header, const std::string& file) {
  if (header.size() < kSpzHeader || LoadLittle<uint32_t>(header, 0) != kSpzMagic) {
    throw InputError("{}: is not a splat in SPZ format; export it again", file);
  }
  const auto version = LoadLittle<uint32_t>(header, 4);
  if (version != 2 && version != 3) {
    throw InputError("{}: is SPZ of version {}, and the versions 2 and 3 can be read; export it as one of them", file,
                     version);
  }
  return static_cast<SpzVersion>(version);
}

}  // namespace

std::string EncodeSpz(const Gaussians& gaussians, int sh_degree, SpzVersion version) {
  gaussians.Check("EncodeSpz");
  const Gaussians turned = HostCopy(gaussians, sh_degree);
  const int64_t n = turned.size();
  const SpzLayout layout(static_cast<uint64_t>(n), sh_degree, version);
  const int bits = FractionalBits(turned);
  const auto steps = static_cast<float>(1 << bits);
  std::string bytes(layout.end, '\0');
  char* out = bytes.data();
  StoreLittle(out, kSpzMagic);
  StoreLittle(out + 4, static_cast<uint32_t>(version));
  StoreLittle(out + 8, static_cast<uint32_t>(n));
  out[12] = static_cast<char>(sh_degree);
  out[13] = static_cast<char>(bits);
  const GaussianRows rows = turned.Rows();
  ParallelBlocks(n, kSplatGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      const GaussianRows g = rows.From(i);
      TurnHalf(g, kTurnAboutX);
      const auto at = static_cast<uint64_t>(i);
      for (int c = 0; c < 3; ++c) {
        PackPosition(g.means[c], steps, out + kSpzHeader + (3 * at + c) * kPositionBytes);
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
  return Gzip(bytes);
}

GaussianPly DecodeSpz(std::string_view bytes, const std::string& file) {
  Gunzip unpacked(bytes, file);
  std::string data = unpacked.Next(kSpzHeader);
  const SpzVersion version = CheckSpzHeader(data, file);
  const auto n = LoadLittle<uint32_t>(data, 8);
  const int degree = static_cast<uint8_t>(data[12]), bits = static_cast<uint8_t>(data[13]);
  if (degree > kMaxShDegree || bits > kMaxFractionalBits) {
    throw InputError("{}: has harmonics of degree {} and {} fractional bits, expected at most {} and {}", file, degree,
                     bits, kMaxShDegree, kMaxFractionalBits);
  }
  const SpzLayout layout(n, degree, version);
  if (layout.end > kSpzPlausibleBytes && layout.end / kSpzMostPerByte > bytes.size()) {
    throw InputError("{}: promises {} Gaussians in {} bytes; the file is damaged", file, n, bytes.size());
  }
  data += unpacked.Next(layout.end - kSpzHeader);
  if (data.size() != layout.end) {
    throw InputError("{}: promises {} Gaussians, which need {} bytes, but holds {}; copy or export it again", file, n,
                     layout.end, data.size());
  }
  const auto steps = static_cast<float>(1 << bits);
  GaussianPly splat = ZeroSplat(n, degree, file);
  const GaussianRows rows = splat.gaussians.Rows();
  const char* in = data.data();
  const auto byte = [in](uint64_t at) { return static_cast<float>(static_cast<uint8_t>(in[at])); };
  ParallelBlocks(n, kSplatGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      const GaussianRows g = rows.From(i);
      const auto at = static_cast<uint64_t>(i);
      for (int c = 0; c < 3; ++c) {
        g.means[c] = UnpackPosition(in + kSpzHeader + (3 * at + c) * kPositionBytes, steps);
        g.sh[c] = (byte(layout.colors + 3 * at + c) / 255 - 0.5f) / kSpzColorScale;
        g.log_scales[c] = byte(layout.scales + 3 * at + c) / kScaleSteps - kScaleOffset;
      }
      g.opacity_logits[0] = LogitOfOpacity(byte(layout.alphas + at) / 255);
      UnpackSpzRotation(in + layout.rotations + layout.rotation_bytes * at, version, g.quats);
      const uint64_t sh = layout.sh + layout.sh_bytes * at;
      for (uint64_t k = 0; k < layout.sh_bytes; ++k) g.sh[3 + k] = (byte(sh + k) - kShSteps) / kShSteps;
      TurnHalf(g, kTurnAboutX);
    }
  });
  return splat;
}

}  // namespace oraclegs
