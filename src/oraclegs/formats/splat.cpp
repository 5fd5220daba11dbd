#include "oraclegs/formats/codecs.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/statistics.h"

namespace oraclegs {
namespace {

constexpr size_t kRowBytes = 32;
constexpr size_t kRowScales = 12, kRowColor = 24, kRowRotation = 28;  // offsets in a row
constexpr float kRotationSteps = 128;

}  // namespace

std::string EncodeSplat(const Gaussians& gaussians) {
  gaussians.Check("EncodeSplat");
  const Gaussians host = gaussians.To(kCpu);
  const GaussianRows rows = host.Rows();
  std::string bytes(static_cast<size_t>(host.size()) * kRowBytes, '\0');
  ParallelBlocks(host.size(), kSplatGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      const GaussianRows g = rows.From(i);
      char* out = bytes.data() + static_cast<size_t>(i) * kRowBytes;
      const std::array<float, 4> q = UnitQuaternion(g.quats);
      for (int c = 0; c < 3; ++c) {
        StoreLittle(out + 4 * c, g.means[c]);
        StoreLittle(out + kRowScales + 4 * c, DeviationOf(g.log_scales[c]));
        out[kRowColor + c] = static_cast<char>(NearestByte((g.sh[c] * static_cast<float>(kConstantSh) + 0.5f) * 255));
      }
      out[kRowColor + 3] = static_cast<char>(NearestByte(Sigmoid(g.opacity_logits[0]) * 255));
      for (int c = 0; c < 4; ++c) {
        out[kRowRotation + c] = static_cast<char>(NearestByte(q[c] * kRotationSteps + kRotationSteps));
      }
    }
  });
  return bytes;
}

GaussianPly DecodeSplat(std::string_view bytes, const std::string& file) {
  if (bytes.size() % kRowBytes != 0) {
    throw InputError("{}: has {} bytes, expected a multiple of {}; the file is cut short or of another format", file,
                     bytes.size(), kRowBytes);
  }
  GaussianPly splat = ZeroSplat(static_cast<int64_t>(bytes.size() / kRowBytes), 0, file);
  const GaussianRows rows = splat.gaussians.Rows();
  ParallelBlocks(splat.gaussians.size(), kSplatGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      const GaussianRows g = rows.From(i);
      const std::string_view in = bytes.substr(static_cast<size_t>(i) * kRowBytes, kRowBytes);
      const auto byte = [in](size_t at) { return static_cast<float>(static_cast<uint8_t>(in[at])); };
      float q[4];
      for (int c = 0; c < 4; ++c) q[c] = (byte(kRowRotation + c) - kRotationSteps) / kRotationSteps;
      std::copy_n(UnitQuaternion(q).data(), 4, g.quats);
      for (int c = 0; c < 3; ++c) {
        g.means[c] = LoadLittle<float>(in, 4 * c);
        g.log_scales[c] = LogOfDeviation(LoadLittle<float>(in, kRowScales + 4 * c));
        g.sh[c] = (byte(kRowColor + c) / 255 - 0.5f) / static_cast<float>(kConstantSh);
      }
      g.opacity_logits[0] = LogitOfOpacity(byte(kRowColor + 3) / 255);
    }
  });
  return WithoutDamaged(std::move(splat), file);
}

}  // namespace oraclegs
