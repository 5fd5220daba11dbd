#pragma once
// What this machine can do at most, now. Turbo and neighbors move it: measure it around whatever it is compared with.

#include <cstdint>
#include <string>

namespace oraclegs {

struct Ceilings {
  double flops = 0;  ///< fused multiply-adds from registers on all threads, 2 flops a lane, per second
  double bytes = 0;  ///< copy of an array far larger than the caches on all threads, read + written, per second
};

/// Medians of a few runs of some milliseconds each, on NumThreads() threads; a third of a second in all. The copy's
/// arrays stay allocated.
Ceilings MeasureCeilings();

/// Mean of two measurements: before and after what is compared with them.
Ceilings Between(const Ceilings& before, const Ceilings& after);

/// The instruction set that Highway dispatches to: "AVX3", "AVX2", ...
std::string SimdTarget();

/// Largest cache of the machine, 0 when it does not say.
int64_t LastLevelCacheBytes();

/// Size of each of the copy's two arrays: twice the largest cache, at least 256 MiB.
int64_t CopyArrayBytes();

}  // namespace oraclegs
