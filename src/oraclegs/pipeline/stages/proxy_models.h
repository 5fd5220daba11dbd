#pragma once

#include <string>
#include <vector>

#include "oraclegs/pipeline/stages/depth_stage.h"
#include "oraclegs/propose/ensemble.h"
#include "oraclegs/train/options.h"

namespace oraclegs {

/// How the quick models are trained: the run's options, decided (train_inputs.h), at a share of its iterations.
TrainOptions OpinionOptions(const RunOptions& options, TrainOptions decided);

/// Trains the models of proposer "splat", each without the photographs LeftOut() names, from what stereo found in the
/// others, and then for --opinion-finish with all. Writes proposals/opinions/K_before.ply and K.ply; one that was
/// finished under the same `key` is read back, so an interrupted run loses at most one. None, with a warning, when
/// there are too few photographs or points.
std::vector<ProxyModel> TrainOpinions(Run* run, const std::vector<LoadedView>& photos, const Geometry& geometry,
                                   const TrainOptions& options, const std::string& key);

}  // namespace oraclegs
