#pragma once
// Random numbers that are a pure function of (seed, stream, counter): nothing to synchronize between threads, the same
// numbers on every device, and a checkpoint stores a counter instead of a generator.

#include <array>
#include <cmath>
#include <cstdint>

#include "oraclegs/core/device_macros.h"

namespace oraclegs {

/// Computes the upper and the lower half of the 64-bit product.
ORACLEGS_HD inline void MultiplyWide(uint32_t a, uint32_t b, uint32_t* high, uint32_t* low) {
  const uint64_t product = uint64_t{a} * b;
  *high = static_cast<uint32_t>(product >> 32);
  *low = static_cast<uint32_t>(product);
}

#include "oraclegs/core/philox_rounds-inl.h"

/// Philox4x32-10 [Salmon 2011]: four 32-bit words.
struct Philox {
  uint32_t x[4];

  ORACLEGS_HD static Philox Draw(uint64_t seed, uint64_t stream, uint64_t counter) {
    Philox c{{static_cast<uint32_t>(counter), static_cast<uint32_t>(counter >> 32), static_cast<uint32_t>(stream),
              static_cast<uint32_t>(stream >> 32)}};
    PhiloxRounds(seed, c.x);
    return c;
  }
  /// Uniform in [0, 1), 53 bits, of the first two words.
  ORACLEGS_HD double Uniform() const { return static_cast<double>((uint64_t{x[0]} << 32 | x[1]) >> 11) * 0x1.0p-53; }
};

/// The independent streams of one run's seed. A new use of randomness gets a new name here.
enum class RandomStream : uint64_t {
  kInitialPoints = 1,
  kViewOrder = 2,
  kRelocate = 3,
  kAdd = 4,
  kNoise = 5,
  kDemoScene = 6,
  kStereo = 7,
  kStereoStandIns = 8,
  kThinning = 9,
  kTargets = 12,
  kOpacityFactors = 16,  // of dropout and opacity noise
  kSeva = 20,            // of the generated views
  kTampering = 21,       // of the pictures that the oracle learns disagreement from
  kGaussianTampering = 22,
  kDepthPatches = 23,  // of depth losses by patches
  kPseudoViews = 24,
  kSplit = 25,  // of Gaussians in two
  kBackground = 26,
  kOraclePass = 27,    // of the images of VGGT's passes
  kSecondMotion = 31,  // of samples of matches
  kStandIns = 32,      // of the Gaussians that copies of a model lack
};

/// Sequential reader of one stream; its whole state is the counter.
class Rng {
 public:
  Rng(uint64_t seed, RandomStream stream, uint64_t counter = 0)
      : seed_(seed), stream_(static_cast<uint64_t>(stream)), counter_(counter) {}

  /// Uniform in [0, 1), 53 bits.
  double Uniform() { return Philox::Draw(seed_, stream_, counter_++).Uniform(); }
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  /// Uniform integer in [0, n), n >= 1.
  int64_t Index(int64_t n) { return static_cast<int64_t>(Uniform() * static_cast<double>(n)); }

  uint64_t counter() const { return counter_; }

 private:
  uint64_t seed_, stream_, counter_;
};

/// Uniform in (0, 1): safe under a logarithm. 23 bits, so that the half added is exact and the largest stays below 1.
ORACLEGS_HD inline float OpenUniform(uint32_t bits) { return (static_cast<float>(bits >> 9) + 0.5f) * 0x1.0p-23f; }

}  // namespace oraclegs
