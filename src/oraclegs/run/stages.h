#pragma once

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Stages of a run, in their order.
const std::vector<Stage>& Stages();

/// RunStage and IsUpToDate for these stages.
inline void RunStage(Run* run, const std::string& name) { RunStage(run, Stages(), name); }
inline bool IsUpToDate(Run* run, const std::string& name) { return IsUpToDate(run, Stages(), name); }

}  // namespace oraclegs
