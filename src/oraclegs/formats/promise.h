#pragma once
// Promises of the splat formats: how far a written file may be from its Gaussians, and whether it is.

#include <cstdint>
#include <string>
#include <vector>

#include "oraclegs/gaussians/gaussians.h"

namespace oraclegs {

/// Largest errors of a format, and the ranges to which it cuts. The visible error goes by the larger of two
/// numbers, the Gaussian's largest standard deviation and the median Gaussian's middle one: a size may be off by a
/// quarter of it besides, and a position by a thousandth of its distance from the middle of the scene.
struct SplatPromise {
  float position;                     ///< error as a fraction of that number
  float log_scale;                    ///< error of the logarithm of a standard deviation
  float color;                        ///< error of a color in [0, 1]
  float lowest_color, highest_color;  ///< colors beyond are cut
  float harmonic;                     ///< error of a higher coefficient
  float largest_harmonic;             ///< those beyond +- it are cut; 0 = the format has none
};

struct PromiseCheck {
  std::vector<int64_t> lost;  ///< Gaussians that are not kept so, ascending
  std::string first;          ///< what the first of them has become
  int64_t cut = 0;            ///< Gaussians whose color or harmonics are cut
};

/// Compares what was read from a file with what was written to it: as many Gaussians in the same order, on the host,
/// all numbers finite. A rotation may be off by a cosine of 0.98, an opacity by 1/500.
PromiseCheck CheckPromise(const Gaussians& given, const Gaussians& read, const SplatPromise& promise);

}  // namespace oraclegs
