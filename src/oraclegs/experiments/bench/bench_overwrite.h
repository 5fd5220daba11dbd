#pragma once
// What --overwrite takes away before a benchmark starts anew.

#include "oraclegs/core/progress.h"
#include "oraclegs/experiments/bench/bench_plan.h"

namespace oraclegs {

inline constexpr char kSlurmFolder[] = "slurm";  ///< in a benchmark's folder: what --launcher slurm keeps

/// Removes the workspaces, records and logs of the plan's runs, and first cancels and forgets all that earlier calls in
/// request.out still have in Slurm's queue: it would be taken for runs of this call. Throws RunError, before anything
/// is removed, where a run still works or the queue cannot be reached; also where something cannot be removed; and what
/// CancelOpenSlurmTasks throws.
void RemoveRuns(const BenchRequest& request, const BenchPlan& plan, const Listener& listener);

}  // namespace oraclegs
