#pragma once
// Inputs of the benchmarks: a seeded synthetic scene and trained runs, brought to any number of Gaussians and pixels.

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/train/trainer.h"

namespace oraclegs {

/// Origin of an input.
struct InputSource {
  std::string name;
  std::filesystem::path workspace;  ///< folder of a finished run; empty = the synthetic scene of tests/render/scenes.h
};

/// Size of an input. Views of another aspect keep it, at the nearest number of pixels.
struct InputSize {
  int64_t gaussians = 0;
  int width = 0, height = 0;  ///< pixels
};

struct BenchInput {
  Gaussians gaussians;
  std::vector<TrainView> views;  ///< without masks
  std::array<float, 3> background{0, 0, 0};
  bool antialiased = false;
};

/// A run's point cloud, thinned by a seeded draw or grown by MCMC's own rule (AddGaussians, again and again: the
/// image stays, faint and small Gaussians become more), and its training views, resized.
/// Throws InputError, UsageError.
BenchInput MakeInput(const InputSource& source, const InputSize& size);

/// Makes a trainer for steady iterations: no relocation and growth, all SH coefficients active. Second moments are so
/// large that steps hardly move parameters, so that every iteration works on the same state; only MCMC's noise moves
/// the faintest Gaussians (fox, 100 000 Gaussians: 3 % fewer pairs after 60 iterations).
std::unique_ptr<Trainer> MakeSteadyTrainer(const BenchInput& input);

/// Makes a trainer with ordinary moments that grows to `max_gaussians` in its first iterations, 5 % in each second one.
/// Takes the input.
std::unique_ptr<Trainer> MakeGrowingTrainer(BenchInput&& input, int64_t max_gaussians);

/// Adam's moments of MakeSteadyTrainer.
Adam SteadyAdam(int64_t n);

}  // namespace oraclegs
