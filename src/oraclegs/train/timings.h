#pragma once
// Time of training by stage.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>

#include "oraclegs/render/render.h"

namespace oraclegs {

/// Milliseconds of an iteration, or means over several, by stage.
struct TrainTimings {
  RenderTimings render;  ///< gaussian_backward: with regularizers, Adam and, unless it refines, noise
  double parts = 0;      ///< parts of other methods, beside the view
  double loss = 0;       ///< photometric, with exposure, and depth
  double refine = 0;     ///< relocation and growth, with the noise of iterations that do so
  double total = 0;

  /// The stages in the order of declaration; without `total`, which Trainer::Run measures.
  std::array<double*, 9> Stages() {
    return {&render.project, &render.bin, &render.blend, &render.blend_backward, &render.gaussian_backward, &parts,
            &loss,           &refine,     &total};
  }

  void Add(TrainTimings other) {
    for (size_t k = 0; k < Stages().size(); ++k) *Stages()[k] += *other.Stages()[k];
  }

  /// These sums divided by the number of iterations.
  TrainTimings Mean(int64_t iterations) const {
    TrainTimings mean = *this;
    for (double* stage : mean.Stages()) *stage /= static_cast<double>(std::max<int64_t>(iterations, 1));
    return mean;
  }
};

/// Seconds since construction.
class Stopwatch {
 public:
  double Seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// Adds the milliseconds since the last lap to a stage.
class Lap {
 public:
  void To(double* milliseconds) {
    const auto now = Clock::now();
    *milliseconds += std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

}  // namespace oraclegs
