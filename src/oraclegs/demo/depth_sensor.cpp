#include "oraclegs/demo/depth_sensor.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/rng.h"
#include "oraclegs/demo/noise.h"

namespace oraclegs {
namespace {

constexpr double kNoise = 5;                           // 1/1000 scene unit
constexpr double kBreak = 1.05;                        // of the depths in a pixel, of different surfaces
constexpr double kHoleShare = 0.3, kDoubtShare = 0.7;  // of ValueNoise: below are holes, above is doubt
constexpr double kDoubtFactor = 1.1, kFarthest = 65534;
constexpr double kLumps = 8;  // across the image
constexpr uint8_t kLow = 0, kMedium = 127, kHigh = 255;
constexpr uint64_t kSeed = uint64_t{1} << 32;  // others than those of the rays
constexpr int kUniforms = 12;                  // whose sum has the variance 1

/// Close to normal, without functions that machines round differently.
double StandardNoise(int view, size_t pixel) {
  double sum = -kUniforms / 2.;
  for (int k = 0; k < kUniforms; ++k) {
    const uint64_t counter = pixel * kUniforms + static_cast<uint64_t>(k);
    sum += Philox::Draw(kSeed + static_cast<uint64_t>(view), static_cast<uint64_t>(RandomStream::kDemoScene), counter)
               .Uniform();
  }
  return sum;
}

}  // namespace

SensedDepth SenseDepth(const std::vector<uint16_t>& truth, int width, int height, int view) {
  SensedDepth out{width / 2, height / 2, {}, {width / 2, height / 2, 1, {}}};
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      uint16_t nearest = 65535, farthest = 0;
      double sum = 0;
      for (int k = 0; k < 4; ++k) {
        const uint16_t z =
            truth[static_cast<size_t>(2 * y + k / 2) * static_cast<size_t>(width) + static_cast<size_t>(2 * x + k % 2)];
        nearest = std::min(nearest, z), farthest = std::max(farthest, z), sum += z / 4.;
      }
      const double lump = ValueNoise({kLumps * x / out.width, kLumps * y / out.width, 10. * view}, 1);
      const bool is_hole = nearest == 0 || lump < kHoleShare;
      const bool is_break = farthest > kBreak * nearest, is_doubt = lump > kDoubtShare;
      const double noisy = sum * (is_doubt ? kDoubtFactor : 1) + kNoise * StandardNoise(view, out.depth.size());
      out.depth.push_back(is_hole ? uint16_t{0} : static_cast<uint16_t>(std::lround(std::clamp(noisy, 1., kFarthest))));
      out.confidence.data.push_back(is_hole || is_doubt ? kLow : is_break ? kMedium : kHigh);
    }
  }
  return out;
}

}  // namespace oraclegs
