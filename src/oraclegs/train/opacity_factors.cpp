#include "oraclegs/train/opacity_factors.h"

#include "oraclegs/core/parallel.h"
#include "oraclegs/train/train_math.h"

namespace oraclegs {
namespace {

constexpr int64_t kOpacityGrain = 4096;  // Gaussians a task

}  // namespace

double DropProbability(double dropout, int64_t iteration, int64_t iterations) {
  if (iteration >= iterations) return 0;
  return dropout * static_cast<double>(iteration) / static_cast<double>(iterations);
}

void DrawOpacityFactors(const OpacityPerturbation& perturbation, const Buffer<float>& factors) {
  RequireShape("DrawOpacityFactors", "factors", factors, {-1});
  if (!(perturbation.drop >= 0 && perturbation.drop < 1) || !(perturbation.noise >= 0)) {
    throw ShapeError("DrawOpacityFactors: drop is {} and noise {}, must be in [0,1) and at least 0", perturbation.drop,
                     perturbation.noise);
  }
  const uint64_t counter = static_cast<uint64_t>(perturbation.iteration) << 32;
  float* out = factors.data();
  ParallelBlocks(factors.count(), kOpacityGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      out[i] = static_cast<float>(
          OpacityFactor(perturbation.seed, counter | static_cast<uint64_t>(i), perturbation.drop, perturbation.noise));
    }
  });
}

}  // namespace oraclegs
