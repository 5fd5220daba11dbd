#pragma once
// Seconds of stages and bytes of memory, before a run begins.

#include "oraclegs/stages/stage.h"
#include "oraclegs/stages/stage_seconds.h"

namespace oraclegs {

/// Seconds that a stage takes on this CPU; 0 where its row does not say.
double EstimateSeconds(const Stage& stage, const EstimateInput& input);

/// Bytes that the run takes at most on a CPU, in this process.
int64_t EstimateRunMemory(const EstimateInput& input);

/// Time that this machine takes for a fixed piece of training on the CPU, divided by that of the reference machine (two
/// idle cores of an AMD EPYC with AVX-512; docs/benchmarks.md): 2 = half as fast. Takes about half a second, measured
/// once a process, with the threads of SetNumThreads.
double CpuSlowness();

}  // namespace oraclegs
