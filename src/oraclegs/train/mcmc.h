#pragma once
// 3DGS-MCMC [Kheradmand 2024]: relocation and growth (docs/method.md#mcmc-relocation).

#include <array>
#include <cstdint>

#include "oraclegs/train/adam.h"
#include "oraclegs/train/densify.h"
#include "oraclegs/train/train_math.h"

namespace oraclegs {

/// New opacity (clamped to [0.005, 1 - 2^-23]) and scale ratio s_new / s of a source of opacity o shared by n
/// Gaussians (docs/method.md#mcmc-relocation), in double.
Relocated Relocate(double opacity, int n);

/// C(n, k) for n, k <= kMaxCopies; exact in double.
using BinomialTable = std::array<std::array<double, kMaxCopies + 1>, kMaxCopies + 1>;
const BinomialTable& Binomials();

/// Moves dead Gaussians onto living ones drawn by opacity (docs/method.md#mcmc-relocation). Returns how many moved.
int64_t RelocateDead(uint64_t seed, int64_t iteration, Gaussians* gaussians, Adam* adam);

/// Grows to min(max_gaussians, floor(1.05 N)) by copies of Gaussians drawn by opacity (docs/method.md#mcmc-growth).
/// Returns the number added. Buffers are grown in place where their memory has room (Buffer::GrownTo).
int64_t AddGaussians(uint64_t seed, int64_t iteration, int64_t max_gaussians, Gaussians* gaussians, Adam* adam);

/// Makes the densifier of 3DGS-MCMC on a CPU.
std::unique_ptr<Densifier> MakeMcmcDensifier(const DensifierSetup& setup);

}  // namespace oraclegs
