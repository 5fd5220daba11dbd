#pragma once
// Times of a run's stages and its memory, before it begins.

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

/// Reports the stages of the run up to its report, with the time of each where it can be predicted
/// (EstimateSeconds), stores these times in run->predicted, and warns where memory may not suffice. Call it
/// when the scene has been read, before the first stage.
void AnnounceStages(Run* run);

}  // namespace oraclegs
