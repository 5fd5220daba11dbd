#pragma once

#include <string>
#include <vector>

#include "oraclegs/pipeline/stages/depth_stage.h"
#include "oraclegs/pipeline/stages/proposers.h"
#include "oraclegs/propose/folder.h"
#include "oraclegs/train/options.h"

namespace oraclegs {

/// Where views are proposed, and what proposes them.
struct ProposalPlan {
  std::string key;                ///< of what everything here was made from; empty without proposals
  std::vector<Target> targets;    ///< for the run's own proposers
  std::vector<ProxyModel> opinions;  ///< of "splat"
  FolderProposals folder;         ///< ready-made ones
};

/// Views of the scene that neither train nor test.
std::vector<int> SpareViews(const Run& run);

/// Everything that proposals depend on beside options and depth: names, lenses and poses of all views, and the files of
/// --proposal-folder. "" for a run without proposals.
std::string ProposalInputs(const Run& run);

/// True when the run's own proposers are to be asked.
bool ProposesViews(const RunOptions& options);

/// Stage "propose": chooses target poses (never a test pose), trains the quick models, has a generative network paint
/// where --proposers names one, and writes what each proposer sees to proposals/PROPOSER/NAME.png, with the poses in
/// proposals/transforms.json. Skipped when nothing it depends on has changed. Without enough confident depth, or
/// without a usable pose, nothing is proposed, with a warning. `decided` are the training options with nothing left to
/// choose.
ProposalPlan RunPropose(Run* run, const std::vector<LoadedView>& photos, const Geometry& geometry,
                        const TrainOptions& decided);

}  // namespace oraclegs
