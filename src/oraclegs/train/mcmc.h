#pragma once
// 3DGS-MCMC [Kheradmand 2024]: relocation, growth, noise and regularisers (docs/method.md#mcmc-relocation).

#include <array>
#include <cstdint>
#include <vector>

#include "oraclegs/train/adam.h"
#include "oraclegs/train/train_math.h"

namespace oraclegs {

/// New opacity (clamped to [0.005, 1 - 2^-23]) and scale ratio s_new / s of a source of opacity o shared by n
/// Gaussians (docs/method.md#mcmc-relocation), in double.
Relocated Relocate(double opacity, int n);

/// C(n, k) for n, k <= kMaxShare; exact in double.
using BinomialTable = std::array<std::array<double, kMaxShare + 1>, kMaxShare + 1>;
const BinomialTable& Binomials();

/// Moves dead Gaussians onto living ones drawn by opacity (docs/method.md#mcmc-relocation). Returns how many moved.
int64_t RelocateDead(uint64_t seed, int64_t iteration, Gaussians* gaussians, Adam* adam);

/// Grows to min(max_gaussians, floor(1.05 N)) by copies of Gaussians drawn by opacity (docs/method.md#mcmc-growth).
/// Returns how many. The buffers of both are grown in place where their memory has room (Buffer::GrownTo).
int64_t AddGaussians(uint64_t seed, int64_t iteration, int64_t max_gaussians, Gaussians* gaussians, Adam* adam);

/// The noise of one iteration: means += Sigma * (epsilon * gate(opacity) * 5e5 * lr_means), epsilon ~ N(0, I) from
/// (seed, iteration, index of the Gaussian) (docs/method.md#mcmc-noise).
struct MeansNoise {
  uint64_t seed = 0;
  int64_t iteration = 0;
  double lr_means = 0;
};
void AddNoise(const MeansNoise& noise, Gaussians* gaussians);
/// The same for Gaussians [begin, end) alone, on this thread; how they are cut into blocks changes no bit.
void AddNoiseToBlock(const MeansNoise& noise, int64_t begin, int64_t end, Gaussians* gaussians);
/// The same with epsilon [N,3] given; for tests.
void AddNoiseFrom(const Buffer<float>& epsilon, double lr_means, Gaussians* gaussians);

struct RegularizerSums {
  double opacity = 0, scale = 0;
};

/// opacity_reg * mean |o| + scale_reg * mean |s|, a block of Gaussians at a time. One object serves many iterations:
/// it reuses its memory.
class Regularizers {
 public:
  /// Reads `gaussians`, which must not be replaced, until the last AddTo. Throws ShapeError.
  void Begin(const Gaussians& gaussians, double opacity_reg, double scale_reg);

  /// Adds the gradients of Gaussians [begin, end) to their rows, the first one for `begin`, and remembers what they add
  /// to the value. `begin` is a multiple of kGradBlock, and so is `end` unless it is the last. Different blocks may be
  /// added from several threads at once.
  void AddTo(int64_t begin, int64_t end, const GaussianRows& grads);

  /// After all blocks. The same bits however they were cut.
  double Value() const;

 private:
  GaussianRows params_{};
  double opacity_weight_ = 0, scale_weight_ = 0;  // per entry
  std::vector<RegularizerSums> sums_;             // of kGradBlock Gaussians each
};

/// All blocks at once, on all threads; returns the value.
double AddRegularizers(const Gaussians& gaussians, double opacity_reg, double scale_reg, Gaussians* grads);

}  // namespace oraclegs
