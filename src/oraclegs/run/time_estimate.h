#pragma once
// Estimate of the time of a run's stages, before it begins.

#include "oraclegs/core/progress.h"
#include "oraclegs/settings/run_size.h"

namespace oraclegs {

struct EstimateInput {
  const RunOptions& options;  ///< its size must be settled
  SceneSize scene;
  int photos = 0;       ///< photos to register; 0 where the scene has poses
  int test_views = 0;   ///< held-out views
  int other_views = 0;  ///< views that neither train nor test: poses of --trajectory dataset
  double slowness = 1;  ///< slowness of the machine (speed_probe.h)
  double covered = 1;   ///< share of the pixels with content; the background of an object costs little
};

/// Seconds that a stage takes on a CPU, from constants measured on the reference machine
/// (docs/benchmarks.md#predicted-times). 0 for an unknown stage, and where a network takes part, whose time is unknown.
double EstimateSeconds(const std::string& stage, const EstimateInput& input);

/// Upper bound of the bytes that the run takes on a CPU, in this process.
int64_t EstimateRunMemory(const EstimateInput& input);

}  // namespace oraclegs
