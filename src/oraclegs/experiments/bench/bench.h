#pragma once
// Runs whole suites: scenes x numbers of views x seeds x methods, each a run of its own that is never done twice.

#include "oraclegs/core/progress.h"
#include "oraclegs/experiments/bench/bench_plan.h"
#include "oraclegs/experiments/bench/bench_table.h"

namespace oraclegs {

/// Runs the plan through the launcher, except runs in request.out/runs that are done. Rewrites bench.json, .md, .tex,
/// .csv, bench-views.svg and bench-time.svg after each run. Runs of one scene, number of views and seed share structure
/// from motion and depth, those of a method whose proposals do not depend on the seed also these: the first of them
/// runs before the others. A run that fails is a row with its reason, and is tried again in the next call; so is a run
/// that a kill left unfinished. Reports "run 4 of 36 ..." and the time left. With request.overwrite the plan's runs are
/// removed first, and everything that the folder's earlier calls still have in Slurm's queue is cancelled. Throws
/// InputError when `out` holds something else or runs with other options; RunError when nothing was scored, another
/// call works in `out`, or files cannot be written; and the launcher's errors.
BenchReport RunBench(const BenchRequest& request, const BenchPlan& plan, Launcher* launcher, const Listener& listener);

}  // namespace oraclegs
