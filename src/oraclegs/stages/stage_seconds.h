#pragma once
// How long the stages of a run will take on a CPU, from constants measured on the reference machine
// (docs/benchmarks.md#predicted-times). A stage's row has its own sum; this is shared by several of them.

#include "oraclegs/settings/run_size.h"

namespace oraclegs {

struct EstimateInput {
  const RunOptions& options;  ///< with its size settled
  SceneSize scene;
  int photos = 0;              ///< number that is registered; 0 where the scene has poses
  int test_views = 0;          ///< held out
  int other_views = 0;         ///< neither train nor test: poses of --trajectory dataset
  double slowness = 1;         ///< factor of the machine's time to the reference machine's (run/time_estimate.h)
  bool refines_poses = false;  ///< stage "poses" runs
  double covered = 1;          ///< share of the pixels that show something: the background of an object costs little
};

/// Pixels of a view at working size, and those of them that show something.
double PixelsOfView(const EstimateInput& input);
double CoveredPixels(const EstimateInput& input);
/// Pixels of a photo as it came.
double FullPixels(const EstimateInput& input);
/// Views that the run's own proposers make.
int ProposalsOf(const EstimateInput& input);

/// Seconds of one training iteration.
double SecondsOfIteration(const EstimateInput& input);
/// Seconds of COLMAP's features and matches of so many photos.
double SecondsOfFeatures(const EstimateInput& input, int photos);
/// Seconds of stereo over the training views.
double SecondsOfStereo(const EstimateInput& input);
/// Seconds of reading and scoring views.
double SecondsOfScores(const EstimateInput& input, double views);
/// Seconds of the render of one image.
double SecondsOfRender(const EstimateInput& input);

}  // namespace oraclegs
