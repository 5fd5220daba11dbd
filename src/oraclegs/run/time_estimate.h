#pragma once

#include "oraclegs/stages/stage.h"
#include "oraclegs/stages/stage_seconds.h"

namespace oraclegs {

/// Seconds that a stage takes on this CPU; 0 where its row does not say.
double EstimateSeconds(const Stage& stage, const EstimateInput& input);

/// Bytes that the run takes at most on a CPU, in this process.
int64_t EstimateRunMemory(const EstimateInput& input);

}  // namespace oraclegs
