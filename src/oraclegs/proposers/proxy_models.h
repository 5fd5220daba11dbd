#pragma once

#include "oraclegs/settings/from_results.h"
#include "oraclegs/stages/proposer_row.h"
#include "oraclegs/train/options.h"

namespace oraclegs {

/// How proxy models are trained: the run's training options at a share of its iterations. Train is TrainOptions, whose
/// rates stay those of the run, or AutoTrainOptions, of which what is automatic stays so.
template <class Train>
Train ProxyOptions(double share, Train train);

/// Options of the training that follows with all views, a course of its own: rates that suit its length bring Gaussians
/// to surfaces that the left-out views alone show, where the run's are too low for so few iterations.
TrainOptions FinishOptions(const RunOptions& options, const TrainEvidence& found);

/// Training views that a proxy model has at first, where there are more.
inline constexpr int kViewsOfProxy = 3;
/// How many proxy models are trained of so many training views: --set proxy-models, or more where each would see fewer
/// views than kViewsOfProxy.
int ProxyCount(const ProposeOptions& options, int views);

/// Stage "proxies": the models of proposer "proxies", each trained without the views that are held out from it, from
/// what stereo found in the others, and then for --set proxy-finish with all (docs/method.md#proxy-models). Writes
/// proposals/proxy_models/K_before.ply and K.ply; an interrupted run loses at most one. None, with a warning, when
/// there are too few views or points. Other target poses are no reason to train them again.
StageWork ProxyStage();

}  // namespace oraclegs
