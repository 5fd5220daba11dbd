#pragma once
// 3DGS-MCMC (Kheradmand et al. 2024): relocation, growth, noise and regularisers (spec/gaussian_core.md 8).

#include <cstdint>

#include "oraclegs/train/adam.h"

namespace oraclegs {

inline constexpr float kDeadOpacity = 0.005f;  ///< at or below: dead, relocated
inline constexpr int kMaxShare = 51;           ///< n is clamped to this in 8.2
/// A smaller gate counts as zero (opacity above about 0.28). The displacement is gate * 5e5 * lr * Sigma * epsilon, and
/// 5e5 * lr is about 100 at most per unit of extent, so what is dropped is below 1e-9 of a Gaussian's own squared size:
/// nothing next to the rounding of a float.
inline constexpr float kMinNoiseGate = 1e-12f;

/// New opacity (clamped to [0.005, 1 - 2^-23]) and scale ratio s_new / s of a source of opacity o shared by n
/// Gaussians (8.2), in double.
struct Relocated {
  double opacity = 0;            ///< clamped
  double opacity_unclamped = 0;  ///< what the scale was computed from
  double scale_ratio = 0;
};
Relocated Relocate(double opacity, int n);

/// Moves dead Gaussians onto living ones drawn by opacity (8.1 step 1). Returns how many moved.
int64_t RelocateDead(uint64_t seed, int64_t iteration, Gaussians* gaussians, Adam* adam);

/// Grows to min(max_gaussians, floor(1.05 N)) by copies of Gaussians drawn by opacity (8.1 step 2). Returns how many.
/// The tensors of both become longer views of their storages where those have room (see GrowRows).
int64_t AddGaussians(uint64_t seed, int64_t iteration, int64_t max_gaussians, Gaussians* gaussians, Adam* adam);

/// means += Sigma * (epsilon * gate(opacity) * 5e5 * lr_means), epsilon ~ N(0, I) from (seed, iteration, index) (8.3).
void AddNoise(uint64_t seed, int64_t iteration, double lr_means, Gaussians* gaussians);
/// The same with epsilon [N,3] given; for tests.
void AddNoiseFrom(const Tensor& epsilon, double lr_means, Gaussians* gaussians);

/// Adds the gradients of opacity_reg * mean |o| + scale_reg * mean |s| to grads; returns the value.
double AddRegularizers(const Gaussians& gaussians, double opacity_reg, double scale_reg, Gaussians* grads);

}  // namespace oraclegs
