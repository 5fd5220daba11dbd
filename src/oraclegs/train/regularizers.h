#pragma once
// Regularizers that keep Gaussians small and transparent where no image needs them (docs/method.md#regularizers).

#include <cstdint>
#include <vector>

#include "oraclegs/gaussians/gaussians.h"
#include "oraclegs/train/step_constants.h"

namespace oraclegs {

/// Weights of the mean opacity and the mean scale in the loss.
struct RegularizerOptions {
  double opacity = 0, scale = 0;

  /// Weights per entry for n Gaussians.
  RegularizerSums PerEntry(int64_t n) const {
    return {opacity / static_cast<double>(n), scale / (3 * static_cast<double>(n))};
  }
};

/// opacity_reg * mean |o| + scale_reg * mean |s|, a block of Gaussians at a time. Reusable over iterations; keeps its
/// memory.
class Regularizers {
 public:
  /// Begins with `gaussians`, which must not be replaced until the last AddTo. Throws ShapeError.
  void Begin(const Gaussians& gaussians, const RegularizerOptions& options);

  /// Adds the gradients of Gaussians [begin, end) to `grads`, whose first row belongs to `begin`, and keeps their part
  /// of the value. `begin` is a multiple of kGradBlock, and so is `end` unless it is the last. Different blocks may be
  /// added from several threads at once.
  void AddTo(int64_t begin, int64_t end, const GaussianRows& grads);

  /// The value after all blocks. The partition into blocks changes no bit.
  double Value() const;

 private:
  GaussianRows params_{};
  RegularizerSums weights_;            // per entry
  std::vector<RegularizerSums> sums_;  // of kGradBlock Gaussians each
};

/// Adds all blocks at once, on all threads. Returns the value.
double AddRegularizers(const Gaussians& gaussians, const RegularizerOptions& options, Gaussians* grads);

}  // namespace oraclegs
