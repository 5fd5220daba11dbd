#pragma once
// How long the stages of a run will take, before it begins.

#include "oraclegs/core/progress.h"
#include "oraclegs/settings/run_size.h"

namespace oraclegs {

struct EstimateInput {
  const RunOptions& options;  ///< with its size settled
  SceneSize scene;
  int photos = 0;       ///< that are registered; 0 where the scene has poses
  int test_views = 0;   ///< held out
  int other_views = 0;  ///< that neither train nor test: poses of --trajectory dataset
  double slowness = 1;  ///< of the machine (speed_probe.h)
  double covered = 1;   ///< share of the pixels that show something: the background of an object costs little
};

/// Seconds that a stage takes on a CPU; 0 for a stage of another name, and where a network takes part, whose time
/// nobody knows. From constants measured on the reference machine (docs/benchmarks.md#predicted-times).
double EstimateSeconds(const std::string& stage, const EstimateInput& input);

/// Bytes that the run takes at most on a CPU, in this process.
int64_t EstimateRunMemory(const EstimateInput& input);

}  // namespace oraclegs
