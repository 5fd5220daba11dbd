#pragma once

#include "oraclegs/stages/stage.h"
#include "oraclegs/train/options.h"

namespace oraclegs {

/// How proxy models are trained: the run's training options at a share of its iterations.
TrainOptions ProxyOptions(const RunOptions& options, TrainOptions train);

/// Training views that a proxy model has at first, where there are more.
inline constexpr int kViewsOfProxy = 3;
/// How many proxy models are trained of so many training views: --proxy-models, or more where each would see fewer
/// views than kViewsOfProxy.
int ProxyCount(const ProposeOptions& options, int views);

/// Dense points without which there is nothing to warp to a new view, and views, of which two show a surface and one is
/// held out.
inline constexpr size_t kMinPointsToPropose = 1000, kMinViewsToPropose = 3;
/// Whether there are as many.
bool CanPropose(const TrainingViews& training, const Geometry& geometry);

/// Whether proxy models alone propose, once stage "proxies" has run: they do not where there were too few views or
/// points for them, and views are warped instead.
bool ProxiesAlonePropose(const Run& run);

/// Stage "proxies": the models of proposer "splat", each trained without the views that are held out from it, from what
/// stereo found in the others, and then for --proxy-finish with all (docs/method.md#proxy-models). Writes
/// proposals/proxies/K_before.ply and K.ply; an interrupted run loses at most one. None, with a warning, when there are
/// too few views or points. Other target poses are no reason to train them again.
StageWork ProxyStage();

}  // namespace oraclegs
