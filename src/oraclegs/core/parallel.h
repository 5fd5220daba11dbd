#pragma once
// The one way to use several cores.

#include <cstdint>

#include "oraclegs/core/function_ref.h"

namespace oraclegs {

/// Threads used by ParallelFor from now on; n <= 0 means all that the machine has.
void SetNumThreads(int n);
int NumThreads();

/// Runs body(0) ... body(tasks - 1), each exactly once, handing tasks to threads as they become free. A thread begins
/// with its share of neighboring tasks, in order.
/// A result is the same for any number of threads as long as tasks write to separate places.
/// An exception thrown by a task is rethrown here (the first one wins) after the running tasks have ended.
void ParallelFor(int64_t tasks, FunctionRef<void(int64_t task)> body);

/// Splits [0, n) into blocks of `grain` items (the last may be shorter) and runs body(begin, end) for each.
/// The blocks depend on n and grain only, never on the number of threads: per-block partial sums are reproducible.
void ParallelBlocks(int64_t n, int64_t grain, FunctionRef<void(int64_t begin, int64_t end)> body);

}  // namespace oraclegs
