#pragma once

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Stages of a run, in their order.
const std::vector<Stage>& Stages();

/// RunStage and IsUpToDate for these stages.
inline void RunStage(Run* run, const std::string& name) { RunStage(run, Stages(), name); }
inline bool IsUpToDate(Run* run, const std::string& name) { return IsUpToDate(run, Stages(), name); }

/// Reports the stages of the run up to its report, with the time of each where it can be predicted
/// (run/time_estimate.h), stores these times in run->predicted; on a CPU it says how much memory the run needs,
/// and warns where that may not be there. Call it when the scene has been read, before the first stage.
void AnnounceStages(Run* run);

}  // namespace oraclegs
