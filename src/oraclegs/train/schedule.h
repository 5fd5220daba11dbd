#pragma once
// Quantities that change with the iteration (docs/method.md#learning-rates, #schedules). Iterations count from 1;
// `iterations` is the horizon of the run (--set horizon).

#include <cstdint>

namespace oraclegs {

/// Learning rate of the means: extent * log-linear 1.6e-4 -> 1.6e-6 over `iterations`.
double MeansLearningRate(int64_t iteration, int64_t iterations, double extent);
/// Factor of the other learning rates, which [Kerbl 2023] keeps constant: 1 over the first half of the run, then
/// log-linear 1 -> `last`.
double RateFactor(int64_t iteration, int64_t iterations, double last);
/// Active SH degree: raised by one at every multiple of `interval`, to at most 3.
int ActiveShDegree(int64_t iteration, int64_t interval = 1000);
/// Learning rate of exposure maps: log-linear 1e-2 -> 1e-3 over `iterations`, as in [Kerbl 2024].
double ExposureLearningRate(int64_t iteration, int64_t iterations);
/// Factor of the depth term: 0.01^t, t = iteration / iterations.
double DepthWeight(int64_t iteration, int64_t iterations);

/// Probability of drawing a proposal instead of a photo: clip(floor + peak * t (1-t)^3, 0, 1). The constants are those
/// of the official implementation; the bump is largest, 0.105, at t = 1/4. Where it `falls`, the second half of the run
/// takes it linearly to 0.
struct ProposalSchedule {
  double floor = 0.1;
  double peak = 1;
  bool falls = false;
};
double SyntheticProbability(int64_t iteration, int64_t iterations, const ProposalSchedule& schedule = {});

}  // namespace oraclegs
