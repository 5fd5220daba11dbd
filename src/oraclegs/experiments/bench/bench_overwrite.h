#pragma once
// Removal of earlier runs for --overwrite.

#include "oraclegs/core/progress.h"
#include "oraclegs/experiments/bench/bench_plan.h"

namespace oraclegs {

inline constexpr char kSlurmFolder[] = "slurm";  ///< folder of --launcher slurm in a benchmark's folder

/// Removes the workspaces, records and logs of the plan's runs. It first cancels and forgets everything that earlier
/// calls in request.out still have in Slurm's queue, which would be taken for runs of this call. Throws RunError before
/// anything is removed when a run still works or the queue cannot be reached; RunError also when something cannot be
/// removed; and as CancelOpenSlurmTasks.
void RemoveRuns(const BenchRequest& request, const BenchPlan& plan, const Listener& listener);

}  // namespace oraclegs
