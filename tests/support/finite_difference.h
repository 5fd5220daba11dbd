#pragma once
// Gradients against central differences.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "oraclegs/core/buffer.h"

namespace oraclegs {

/// Compares every `stride`-th entry of `gradient` with the central difference of `loss()` over the same entry of
/// `values`, within 2e-3 of the largest entry. The best of three steps is taken, since a pixel that crosses a threshold
/// between the two sides is a jump, not a derivative.
template <class Loss>
void ExpectCentralDifferences(const char* name, const Loss& loss, std::vector<double>& values,
                              const Buffer<float>& gradient, size_t stride = 1) {
  double scale = 0;
  for (const float g : gradient.span()) scale = std::max<double>(scale, std::abs(g));
  for (size_t k = 0; k < values.size(); k += stride) {
    double best = 1e30;
    for (const double step : {1e-4, 1e-5, 1e-6}) {
      const double keep = values[k];
      values[k] = keep + step;
      const double above = loss();
      values[k] = keep - step;
      best = std::min(best, std::abs((above - loss()) / (2 * step) - gradient[static_cast<int64_t>(k)]));
      values[k] = keep;
    }
    EXPECT_LE(best, 2e-3 * scale) << name << " " << k;
  }
}

}  // namespace oraclegs
