#include "oraclegs/train/opacity_factors.h"

#include <algorithm>
#include <cmath>

#include "oraclegs/core/parallel.h"
#include "oraclegs/core/rng.h"

namespace oraclegs {
namespace {

constexpr int64_t kGrain = 4096;  // Gaussians a task
constexpr double kTau = 6.283185307179586;

/// Box and Muller's, of two uniform numbers in (0, 1).
double Normal(float u, float v) {
  return std::sqrt(-2 * std::log(static_cast<double>(u))) * std::cos(kTau * static_cast<double>(v));
}

}  // namespace

double DropProbability(double dropout, int64_t iteration, int64_t iterations) {
  if (iteration >= iterations) return 0;
  return dropout * static_cast<double>(iteration) / static_cast<double>(iterations);
}

void DrawOpacityFactors(const OpacityPerturbation& perturbation, const Tensor& factors) {
  RequireFloat("DrawOpacityFactors", "factors", factors, {-1});
  if (!(perturbation.drop >= 0 && perturbation.drop < 1) || !(perturbation.noise >= 0)) {
    throw ShapeError("DrawOpacityFactors: drop is {} and noise {}, must be in [0,1) and at least 0", perturbation.drop,
                     perturbation.noise);
  }
  const uint64_t counter = static_cast<uint64_t>(perturbation.iteration) << 32;
  const double kept = 1 / (1 - perturbation.drop);
  float* out = factors.data_ptr<float>();
  ParallelBlocks(factors.numel(), kGrain, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      const Philox r = Philox::Draw(perturbation.seed, static_cast<uint64_t>(RandomStream::kOpacityFactors),
                                    counter | static_cast<uint64_t>(i));
      double factor = static_cast<double>(OpenUniform(r.x[0])) < perturbation.drop ? 0 : kept;
      if (perturbation.noise > 0) {
        factor *= std::max(0.0, 1 + perturbation.noise * Normal(OpenUniform(r.x[1]), OpenUniform(r.x[2])));
      }
      out[i] = static_cast<float>(factor);
    }
  });
}

}  // namespace oraclegs
