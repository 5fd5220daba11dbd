#pragma once
// What the tests of this floor share: random Gaussians, comparisons to the bit, every instruction set.

#include <hwy/targets.h>

#include <functional>

#include "oraclegs/core/parallel.h"
#include "oraclegs/gaussians/gaussians.h"
#include "support/buffers.h"

namespace oraclegs {

/// n Gaussians of sizes around exp(-2), opacities over (0, 1), all sh set.
inline Gaussians RandomGaussians(int64_t n, uint64_t seed) {
  const auto normal = [&](const Shape& shape, uint64_t tensor) { return RandomNormal(shape, 8 * seed + tensor); };
  Gaussians g;
  g.means = normal({n, 3}, 0);
  g.log_scales = normal({n, 3}, 1);
  Flat(g.log_scales) = 0.5f * Flat(g.log_scales) - 2;
  g.quats = normal({n, 4}, 2);
  g.opacity_logits = normal({n}, 3);
  Flat(g.opacity_logits) *= 3;
  g.sh = normal({n, 16, 3}, 4);
  Flat(g.sh) *= 0.3f;
  return g;
}

inline std::vector<Buffer<float>> Tensors(const Gaussians& gaussians) {
  std::vector<Buffer<float>> all;
  gaussians.ForEach([&](const char*, const Buffer<float>& t) { all.push_back(t); });
  return all;
}

inline bool SameBits(const Gaussians& a, const Gaussians& b) {
  const auto x = Tensors(a), y = Tensors(b);
  for (size_t i = 0; i < x.size(); ++i) {
    if (!SameBytes(x[i], y[i])) return false;
  }
  return true;
}

/// Runs body once for every instruction set that this build has and this machine can run.
inline void ForEachTarget(const std::function<void(int64_t target)>& body) {
  const auto choose = [](int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  };
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    choose(target);
    body(target);
  }
  choose(0);
}

/// Sets the number of threads for a scope.
class Threads {
 public:
  explicit Threads(int n) : before_(NumThreads()) { SetNumThreads(n); }
  ~Threads() { SetNumThreads(before_); }

 private:
  int before_;
};

}  // namespace oraclegs
