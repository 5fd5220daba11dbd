#pragma once
// The machine's present limits. Turbo and other load change them: measure them around whatever is compared with them.

#include <cstdint>
#include <string>

namespace oraclegs {

struct Ceilings {
  double flops = 0;  ///< fused multiply-adds from registers on all threads, 2 flops a lane, per second
  double bytes = 0;  ///< copy of an array far larger than the caches on all threads, read + written, per second
};

/// Measures medians of a few runs of some milliseconds each, on NumThreads() threads; a third of a second in all. The
/// copy's arrays stay allocated.
Ceilings MeasureCeilings();

/// Mean of two measurements: before and after the work compared with them.
Ceilings Between(const Ceilings& before, const Ceilings& after);

/// Name of the instruction set that Highway dispatches to: "AVX3", "AVX2", ...
std::string SimdTarget();

/// Largest cache of the machine, bytes; 0 when unknown.
int64_t LastLevelCacheBytes();

/// Size of each of the copy's two arrays: twice the largest cache, at least 256 MiB.
int64_t CopyArrayBytes();

}  // namespace oraclegs
