// One thread per pixel. A thread compares one plane in one source at a time without other threads: no barrier and no
// reduction, where one warp per pixel (41 samples on 32 lanes, a third of them idle) would add some twenty shuffles to
// each comparison. A warp has 32 neighboring columns of two rows, in which the pixels of one color alternate: once
// neighbors agree on planes, a warp's samples are adjacent in the source, and its windows overlap in the cache. The
// price: lanes wait for each other where pixels differ in how many planes are allowed.

#include "oraclegs/depth/cuda/half_sweep.h"

#include <cmath>

#include "oraclegs/core/cuda/launch.h"

namespace oraclegs::cuda {
namespace {

constexpr int kTileWidth = 32, kTileHeight = 8;         // pixels of a block, half of them of one color
constexpr int kThreads = kTileWidth * kTileHeight / 2;  // few: each has long arrays, which the cache must hold

/// First of the four pixels in an image's word.
ORACLEGS_HD inline float ValueOf(uint32_t word) { return static_cast<float>(word & 255); }

/// Bilinear sample between a word's four pixels.
ORACLEGS_HD inline float Interpolate(uint32_t word, float fx, float fy) {
  const float p00 = ValueOf(word), p10 = ValueOf(word >> 8), p01 = ValueOf(word >> 16), p11 = ValueOf(word >> 24);
  const float top = p00 + fx * (p10 - p00), bottom = p01 + fx * (p11 - p01);
  return top + fy * (bottom - top);
}

/// A pixel's surroundings in the searched view. Only their weights are stored (164 bytes of local memory, which a warp
/// reads line by line); values are read again, since a warp's windows overlap. All values are relative to the pixel's
/// own: correlations do not change, and float sums of squares lose no digits.
template <int kChannels>
class DevicePatch {
 public:
  /// Makes the patch around (x, y), which must be usable.
  ORACLEGS_HD inline DevicePatch(const HalfSweep& sweep, int x, int y) : sweep_(sweep), x_(x), y_(y) {
    const int64_t pixels = Pixels(sweep.image), here = sweep.view.Index(x, y);
    for (int c = 0; c < kChannels; ++c) own_[c] = ValueOf(sweep.image.words[c * pixels + here]);
    float total = 0, squares = 0, sums[kChannels] = {};
    int k = 0;
    for (int dy = -kPatchRadius; dy <= kPatchRadius; ++dy) {
      for (int dx = -kPatchRadius + (dy & 1); dx <= kPatchRadius; dx += 2) {
        float values[kChannels];
        const float weight = WeightOf(dx, dy, values);
        weights_[k++] = weight;
        if (!(weight > 0)) continue;
        total += weight;
        for (int c = 0; c < kChannels; ++c) {
          sums[c] += weight * values[c];
          squares += weight * values[c] * values[c];
        }
      }
    }
    inverse_total_ = 1 / total;  // the pixel's own weight is 1
    variance_ = squares * inverse_total_;
    for (int c = 0; c < kChannels; ++c) {
      means_[c] = sums[c] * inverse_total_;
      variance_ -= means_[c] * means_[c];
    }
  }

  /// Fills costs[p * num_sources + s], see PatchCosts. The loop over sources is the outer one, so that a warp stays in
  /// one image.
  ORACLEGS_HD inline void operator()(const Plane* planes, int count, const uint8_t* active, float* costs) const {
    const int n = sweep_.view.num_sources;
    for (int s = 0; s < n; ++s) {
      const PlainPixelMap& map = sweep_.view.sources[s].there;
      const Vec3f far = map(static_cast<float>(x_) + 0.5f, static_cast<float>(y_) + 0.5f, 0);
      for (int p = 0; p < count; ++p) {
        const Homography h{Along(far, map.translation, planes[p].inv_depth),
                           Along(map.right, map.translation, planes[p].dx),
                           Along(map.down, map.translation, planes[p].dy)};
        const bool comparable = active[s] != 0 && IsComparable(h, sweep_.sources[s]);
        costs[p * n + s] = comparable ? Cost(h, sweep_.sources[s]) : kWorstCost;
      }
    }
  }

 private:
  /// Positions of the patch's samples in the source: base + dx right + dy down, homogeneous.
  struct Homography {
    Vec3f base, right, down;
  };

  ORACLEGS_HD inline static int64_t Pixels(const SweepImage& image) {
    return static_cast<int64_t>(image.width) * image.height;
  }
  ORACLEGS_HD inline static Vec3f Along(const Vec3f& from, const Vec3f& direction, float length) {
    return {from.x + direction.x * length, from.y + direction.y * length, from.z + direction.z * length};
  }

  /// Returns the sample's bilateral weight, 0 where it is not used, and writes its values.
  ORACLEGS_HD inline float WeightOf(int dx, int dy, float* values) const {
    const int x = x_ + dx, y = y_ + dy;
    const SweepImage& image = sweep_.image;
    if (x < 0 || y < 0 || x >= image.width || y >= image.height || !sweep_.view.IsUsable(x, y)) return 0;
    float difference = 0;
    for (int c = 0; c < kChannels; ++c) {
      values[c] = ValueOf(image.words[c * Pixels(image) + sweep_.view.Index(x, y)]) - own_[c];
      difference += std::fabs(values[c]);
    }
    const float mean = std::floor((difference + 0.5f) / kChannels);  // in whole steps, as on the CPU
    constexpr auto kNear = static_cast<float>(-1 / (2 * kSigmaPixels * kSigmaPixels));
    constexpr auto kLike = static_cast<float>(-1 / (2 * kSigmaValue * kSigmaValue));
    return std::exp(kNear * static_cast<float>(dx * dx + dy * dy) + kLike * mean * mean);
  }

  ORACLEGS_HD inline static bool IsComparable(const Homography& h, const SweepImage& image) {
    const float z = h.base.z;
    const float nearest = z - kPatchRadius * (std::fabs(h.right.z) + std::fabs(h.down.z));
    if (!(z > 0) || !(nearest > kNearestShare * z)) return false;
    return h.base.x >= 0 && h.base.y >= 0 && h.base.x <= z * static_cast<float>(image.width) &&
           h.base.y <= z * static_cast<float>(image.height);
  }

  ORACLEGS_HD inline float Cost(const Homography& h, const SweepImage& image) const {
    const float max_x = static_cast<float>(image.width - 1), max_y = static_cast<float>(image.height - 1);
    const int64_t pixels = Pixels(image), own_pixels = Pixels(sweep_.image);
    float squares = 0, cross = 0, sums[kChannels] = {};
    for (int dy = -kPatchRadius; dy <= kPatchRadius; ++dy) {
      const Vec3f row = Along(h.base, h.down, static_cast<float>(dy));
      const int odd = dy & 1;
      const int first = (9 * (dy + kPatchRadius) + 1) / 2;  // of the row's samples
#pragma unroll
      for (int i = 0; i <= kPatchRadius; ++i) {
        if (odd + i > kPatchRadius) continue;
        const float weight = weights_[first + i];
        if (!(weight > 0)) continue;  // beyond the border, or masked
        const int dx = 2 * i + odd - kPatchRadius;
        const Vec3f q = Along(row, h.right, static_cast<float>(dx));
        const float inverse = 1 / q.z;
        const float x = fminf(fmaxf(q.x * inverse - 0.5f, 0.f), max_x);
        const float y = fminf(fmaxf(q.y * inverse - 0.5f, 0.f), max_y);
        const int xi = static_cast<int>(x), yi = static_cast<int>(y);
        const float fx = x - static_cast<float>(xi), fy = y - static_cast<float>(yi);
        const int64_t at = static_cast<int64_t>(yi) * image.width + xi;
        const int64_t own_at = sweep_.view.Index(x_ + dx, y_ + dy);
#pragma unroll
        for (int c = 0; c < kChannels; ++c) {
          const float value = Interpolate(image.words[c * pixels + at], fx, fy) - own_[c];
          const float own = ValueOf(sweep_.image.words[c * own_pixels + own_at]) - own_[c];
          const float weighted = weight * value;
          sums[c] += weighted;
          squares += weighted * value;
          cross += weighted * own;
        }
      }
    }
    float variance = squares * inverse_total_, covariance = cross * inverse_total_;
    for (int c = 0; c < kChannels; ++c) {
      const float mean = sums[c] * inverse_total_;
      variance -= mean * mean;
      covariance -= mean * means_[c];
    }
    constexpr float kGuard = kNoiseVariance * kChannels;
    const float ncc = covariance / std::sqrt((fmaxf(variance_, 0.f) + kGuard) * (fmaxf(variance, 0.f) + kGuard));
    return fminf(fmaxf(1 - ncc, 0.f), kWorstCost);
  }

  const HalfSweep& sweep_;
  int x_, y_;
  float own_[kChannels], means_[kChannels];
  float weights_[kPatchSamples];  ///< not divided by their sum
  float inverse_total_ = 0, variance_ = 0;
};

template <int kChannels>
__global__ void __launch_bounds__(kThreads) ImprovePixels(const __grid_constant__ HalfSweep sweep) {
  const int columns = (sweep.view.width + kTileWidth - 1) / kTileWidth;
  const int tile = static_cast<int>(blockIdx.x), thread = static_cast<int>(threadIdx.x);
  const int x = tile % columns * kTileWidth + thread % kTileWidth;
  const int y = tile / columns * kTileHeight + thread / kTileWidth * 2 + ((x + sweep.color) & 1);
  if (x >= sweep.view.width || y >= sweep.view.height || !sweep.view.IsUsable(x, y)) return;
  const DevicePatch<kChannels> patch(sweep, x, y);
  PixelSearch<DevicePatch<kChannels>>(sweep.view, x, y, patch).Improve(sweep.iteration);
}

}  // namespace

void RunHalfSweep(const HalfSweep& sweep, cudaStream_t stream) {
  const int64_t columns = (sweep.view.width + kTileWidth - 1) / kTileWidth;
  const LaunchShape shape{columns * ((sweep.view.height + kTileHeight - 1) / kTileHeight), kThreads};
  Launch("stereo's search", sweep.channels == 1 ? ImprovePixels<1> : ImprovePixels<3>, shape, stream, sweep);
}

}  // namespace oraclegs::cuda
