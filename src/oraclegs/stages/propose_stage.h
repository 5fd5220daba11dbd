#pragma once

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Views of the scene that neither train nor test.
std::vector<int> SpareViews(const Run& run);

/// True where what is proposed depends on a run's seed; else runs of several seeds can share it. A generator's own seed
/// is an option of its own.
bool AreProposalsSeeded(const RunOptions& options);

/// Stage "propose": chooses target poses (never a test pose), has a generative network or the command of --generator
/// paint where they are asked for, and writes what each proposer predicts to proposals/PROPOSER/NAME.png, with the
/// poses in proposals/transforms.json; reads a folder of proposals. The candidates stay in memory for stage "validate",
/// as far as they fit. Without enough confident depth, or without a usable pose, nothing is proposed, with a warning.
StageWork ProposeStage();

}  // namespace oraclegs
