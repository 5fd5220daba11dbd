// A vector holds neighboring samples of one patch; a sample is one gather of a GatherImage word per channel.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "oraclegs/depth/patch_cost.cpp"
#include "oraclegs/core/hwy_targets.h"
// clang-format off: foreach_target must come before the other Highway headers
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "oraclegs/core/simd/lanes-inl.h"
#include "oraclegs/depth/patch_cost.h"

HWY_BEFORE_NAMESPACE();
namespace oraclegs::HWY_NAMESPACE {
using UintTag = hn::RebindToUnsigned<FloatTag>;

HWY_INLINE FloatVec ByteOf(hn::Vec<UintTag> word) { return hn::ConvertTo(FloatTag(), hn::BitCast(IntTag(), word)); }

/// Pixel coordinates of a patch's samples: base + dx * right + dy * down, homogeneous.
struct Homography {
  Eigen::Vector3f base, right, down;
};

template <int kChannels>
HWY_INLINE float Cost(const Patch& patch, const GatherImage& image, const Homography& h) {
  const FloatTag f;
  const IntTag i;
  const PatchOffsets& offsets = Offsets();
  const FloatVec max_x = hn::Set(f, static_cast<float>(image.width - 1)),
                 max_y = hn::Set(f, static_cast<float>(image.height - 1));
  const FloatVec half = hn::Set(f, 0.5f), zero = hn::Zero(f);
  const auto stride = hn::Set(i, image.width);
  const auto byte = hn::Set(UintTag(), 255u);
  FloatVec sums[kChannels], cross = zero, squares = zero;
  for (FloatVec& sum : sums) sum = zero;
  for (size_t k = 0; k < kPatchSlots; k += hn::Lanes(f)) {
    const FloatVec dx = hn::Load(f, &offsets.x[k]), dy = hn::Load(f, &offsets.y[k]);
    const auto along = [&](int row) {
      return hn::MulAdd(dx, hn::Set(f, h.right[row]), hn::MulAdd(dy, hn::Set(f, h.down[row]), hn::Set(f, h.base[row])));
    };
    const FloatVec inverse = hn::Div(hn::Set(f, 1.f), along(2));
    const FloatVec x = hn::Min(hn::Max(hn::Sub(hn::Mul(along(0), inverse), half), zero), max_x);
    const FloatVec y = hn::Min(hn::Max(hn::Sub(hn::Mul(along(1), inverse), half), zero), max_y);
    const auto xi = hn::ConvertTo(i, x), yi = hn::ConvertTo(i, y);
    const FloatVec fx = hn::Sub(x, hn::ConvertTo(f, xi)), fy = hn::Sub(y, hn::ConvertTo(f, yi));
    const auto index = hn::Add(hn::Mul(yi, stride), xi);
    const FloatVec weight = hn::Load(f, patch.weight + k);
    for (int c = 0; c < kChannels; ++c) {
      const auto word = hn::GatherIndex(UintTag(), image.channels[static_cast<size_t>(c)].data(), index);
      const FloatVec p00 = ByteOf(hn::And(word, byte)), p10 = ByteOf(hn::And(hn::ShiftRight<8>(word), byte));
      const FloatVec p01 = ByteOf(hn::And(hn::ShiftRight<16>(word), byte)), p11 = ByteOf(hn::ShiftRight<24>(word));
      const FloatVec top = hn::MulAdd(fx, hn::Sub(p10, p00), p00), bottom = hn::MulAdd(fx, hn::Sub(p11, p01), p01);
      const FloatVec value = hn::MulAdd(fy, hn::Sub(bottom, top), top);
      const FloatVec weighted = hn::Mul(weight, value);
      sums[c] = hn::Add(sums[c], weighted);
      squares = hn::MulAdd(weighted, value, squares);
      cross = hn::MulAdd(hn::Load(f, patch.centerd[c] + k), value, cross);
    }
  }
  float variance = hn::GetLane(hn::SumOfLanes(f, squares));
  for (const FloatVec& sum : sums) {
    const float mean = hn::GetLane(hn::SumOfLanes(f, sum));
    variance -= mean * mean;
  }
  const float guard = kNoiseVariance * kChannels;
  const float ncc =
      hn::GetLane(hn::SumOfLanes(f, cross)) / std::sqrt((patch.variance + guard) * (std::max(variance, 0.f) + guard));
  return std::clamp(1 - ncc, 0.f, kWorstCost);
}

HWY_INLINE bool Comparable(const Homography& h, const GatherImage& image) {
  const float z = h.base.z();
  const float nearest = z - kPatchRadius * (std::abs(h.right.z()) + std::abs(h.down.z()));
  if (!(z > 0) || !(nearest > kNearestShare * z)) return false;
  return h.base.x() >= 0 && h.base.y() >= 0 && h.base.x() <= z * static_cast<float>(image.width) &&
         h.base.y() <= z * static_cast<float>(image.height);
}

void Costs(const Patch& patch, const PatchHypotheses& hypotheses, float* costs) {
  const size_t num_sources = hypotheses.sources.size();
  for (size_t s = 0; s < num_sources; ++s) {
    const GatherImage& image = *hypotheses.sources[s].image;
    const PixelMap& map = hypotheses.sources[s].map;
    const Eigen::Vector3f far = map(patch.u, patch.v, 0);
    for (size_t p = 0; p < hypotheses.planes.size(); ++p) {
      const Plane& plane = hypotheses.planes[p];
      float& cost = costs[p * num_sources + s];
      cost = kWorstCost;
      if (hypotheses.active[s] == 0) continue;
      const Homography h{far + map.translation * plane.inv_depth, map.rotation.col(0) + map.translation * plane.dx,
                         map.rotation.col(1) + map.translation * plane.dy};
      if (!Comparable(h, image)) continue;
      cost = image.channels.size() == 1 ? Cost<1>(patch, image, h) : Cost<3>(patch, image, h);
    }
  }
}

}  // namespace oraclegs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace oraclegs {
namespace {

HWY_EXPORT(Costs);

PatchOffsets MakeOffsets() {
  PatchOffsets offsets;
  size_t n = 0;
  for (int y = -kPatchRadius; y <= kPatchRadius; ++y) {
    for (int x = -kPatchRadius; x <= kPatchRadius; ++x) {
      if ((x + y) % 2 != 0) continue;
      offsets.x[n] = static_cast<float>(x);
      offsets.y[n++] = static_cast<float>(y);
    }
  }
  return offsets;
}

/// Values exp(-d^2 / (2 sigma^2)) for every 8-bit difference and every offset.
struct BilateralTables {
  std::array<float, 256> value;
  std::array<float, kPatchSamples> distance;
};

BilateralTables MakeTables() {
  BilateralTables tables{};
  for (size_t d = 0; d < 256; ++d) {
    tables.value[d] = static_cast<float>(std::exp(-std::pow(static_cast<double>(d) / kSigmaValue, 2) / 2));
  }
  for (size_t k = 0; k < kPatchSamples; ++k) {
    const double r2 = std::pow(Offsets().x[k], 2) + std::pow(Offsets().y[k], 2);
    tables.distance[k] = static_cast<float>(std::exp(-r2 / (2 * kSigmaPixels * kSigmaPixels)));
  }
  return tables;
}

}  // namespace

const PatchOffsets& Offsets() {
  static const PatchOffsets offsets = MakeOffsets();
  return offsets;
}

Patch MakePatch(const GatherImage& image, int x, int y, const uint8_t* usable) {
  static const BilateralTables tables = MakeTables();
  const PatchOffsets& offsets = Offsets();
  const int channels = static_cast<int>(image.channels.size());
  Patch patch;
  patch.u = static_cast<float>(x) + 0.5f;
  patch.v = static_cast<float>(y) + 0.5f;
  float values[kMaxChannels][kPatchSamples];
  float total = 0;
  for (int k = 0; k < kPatchSamples; ++k) {
    const int sx = x + static_cast<int>(offsets.x[k]), sy = y + static_cast<int>(offsets.y[k]);
    const bool usable_sample = sx >= 0 && sy >= 0 && sx < image.width && sy < image.height &&
                               (usable == nullptr || usable[static_cast<size_t>(sy) * image.width + sx] != 0);
    int difference = 0;
    for (int c = 0; c < channels; ++c) {
      const int value = usable_sample ? image.Value(c, sx, sy) : 0;
      values[c][k] = static_cast<float>(value);
      difference += std::abs(value - image.Value(c, x, y));
    }
    patch.weight[k] = usable_sample ? tables.distance[k] * tables.value[difference / channels] : 0;
    total += patch.weight[k];
  }
  if (!(total > 0)) return patch;
  for (int k = 0; k < kPatchSamples; ++k) patch.weight[k] /= total;
  for (int c = 0; c < channels; ++c) {
    float mean = 0;
    for (int k = 0; k < kPatchSamples; ++k) mean += patch.weight[k] * values[c][k];
    for (int k = 0; k < kPatchSamples; ++k) {
      patch.centerd[c][k] = patch.weight[k] * (values[c][k] - mean);
      patch.variance += patch.centerd[c][k] * (values[c][k] - mean);
    }
  }
  return patch;
}

void PatchCosts(const Patch& patch, const PatchHypotheses& hypotheses, float* costs) {
  HWY_DYNAMIC_DISPATCH(Costs)(patch, hypotheses, costs);
}

}  // namespace oraclegs
#endif
