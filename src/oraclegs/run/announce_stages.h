#pragma once

#include "oraclegs/stages/stage.h"

namespace oraclegs {

/// Reports the stages that the run will go through up to its report, with the time that each will take where that can
/// be known (estimate/time_estimate.h), keeps these times in run->predicted, and warns where memory may not suffice.
/// For a run whose scene has been read, before its first stage.
void AnnounceStages(Run* run);

}  // namespace oraclegs
