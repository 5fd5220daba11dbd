#pragma once

#include "oraclegs/stages/run_stage.h"

namespace oraclegs {

/// The stages of a run, in their order.
const std::vector<Stage>& Stages();

/// RunStage, IsUpToDate of these.
inline void RunStage(Run* run, const std::string& name) { RunStage(run, Stages(), name); }
inline bool IsUpToDate(Run* run, const std::string& name) { return IsUpToDate(run, Stages(), name); }

}  // namespace oraclegs
