#pragma once
// What a run asks a GPU for a few times only, before it trains, beside the same on the CPU.

#include <string>

#include "bench/gpu_training.h"

namespace oraclegs {

/// Milliseconds; the GPU's the median of several, the CPU's of one.
struct OnBoth {
  double gpu = 0, cpu = 0;
};

struct GpuOnce {
  double points = 0, photographs = 0;
  OnBoth neighbors;  ///< of the scene's number of points
  OnBoth warp;       ///< a view of the scene's size, holes filled (on the CPU) and all
};

GpuOnce MeasureOnce(const GpuScene& scene, int photographs, int passes);

/// Lines of text, each ended.
std::string OnceText(const GpuOnce& once);

}  // namespace oraclegs
