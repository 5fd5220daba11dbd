#pragma once
// What the stages are measured on: a seeded synthetic scene and trained runs, brought to any number of Gaussians and
// pixels.

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "oraclegs/train/trainer.h"

namespace oraclegs {

/// Where an input comes from.
struct InputSource {
  std::string name;
  std::filesystem::path workspace;  ///< of a finished run; empty = the synthetic scene of tests/render/scenes.h
};

/// Views of another aspect keep it, at the nearest number of pixels.
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

/// A trainer that only ever iterates: no relocation and growth, all SH coefficients active. Second moments are so large
/// that a step moves parameters by next to nothing, so that every iteration works on the same state but for MCMC's
/// noise, which moves the faintest (fox, 100 000 Gaussians: 3 % fewer pairs after 60 iterations).
std::unique_ptr<Trainer> MakeSteadyTrainer(const BenchInput& input);

/// The same, but it starts with ordinary moments and grows from the Gaussians it has to `max_gaussians` in its first
/// iterations, 5 % each second one. Takes the input.
std::unique_ptr<Trainer> MakeGrowingTrainer(BenchInput&& input, int64_t max_gaussians);

/// Adam's moments of MakeSteadyTrainer.
Adam SteadyAdam(int64_t n);

}  // namespace oraclegs
