#include "oraclegs/loss/depth_losses.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "oraclegs/core/parallel.h"

namespace oraclegs {
namespace {

constexpr int64_t kPixelGrain = 1 << 14;  // pixels a task, at least
constexpr int64_t kMaxTasks = 256;        // so that their sums need no heap
constexpr int kSums = 8;                  // independent sums, so that additions need not wait for each other

/// Sum of |a - b| * mask over [begin, end); a null mask is 1 everywhere.
double MaskedDistance(const float* a, const float* b, const float* mask, int64_t begin, int64_t end) {
  const auto distance = [=](int64_t i) {
    return static_cast<double>(std::abs(a[i] - b[i]) * (mask == nullptr ? 1 : mask[i]));
  };
  double sums[kSums] = {};
  int64_t i = begin;
  for (; i + kSums <= end; i += kSums) {
    for (int k = 0; k < kSums; ++k) sums[k] += distance(i + k);
  }
  for (; i < end; ++i) sums[0] += distance(i);
  double total = 0;
  for (const double sum : sums) total += sum;
  return total;
}

}  // namespace

double MaskedL1(const Buffer<float>& rendered, const Buffer<float>& target, const Buffer<float>& mask, double weight,
                Buffer<float>* grad) {
  RequireShape("MaskedL1", "rendered", rendered, {-1, -1});
  const int64_t height = rendered.size(0), width = rendered.size(1), n = height * width;
  RequireShape("MaskedL1", "target", target, {height, width});
  if (mask.defined()) RequireShape("MaskedL1", "mask", mask, {height, width});
  float* g = nullptr;
  if (grad != nullptr && grad->defined()) {
    RequireShape("MaskedL1", "grad", *grad, {height, width});
    g = grad->data();
  }
  if (n == 0) throw ShapeError("MaskedL1: rendered is empty");

  const float* a = rendered.data();
  const float* b = target.data();
  const float* m = mask.defined() ? mask.data() : nullptr;
  const float step = static_cast<float>(weight / static_cast<double>(n));
  const int64_t grain = std::max(kPixelGrain, (n + kMaxTasks - 1) / kMaxTasks);
  std::array<double, kMaxTasks> sums = {};
  ParallelBlocks(n, grain, [&](int64_t begin, int64_t end) {
    sums[begin / grain] = MaskedDistance(a, b, m, begin, end);
    if (g == nullptr) return;
    for (int64_t i = begin; i < end; ++i) {
      const float sign = static_cast<float>(a[i] > b[i]) - static_cast<float>(a[i] < b[i]);
      g[i] = step * sign * (m == nullptr ? 1 : m[i]);
    }
  });
  double total = 0;
  for (const double sum : sums) total += sum;
  return weight * total / static_cast<double>(n);
}

}  // namespace oraclegs
