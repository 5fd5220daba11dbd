#pragma once
// Ends what an earlier process left running on a cluster, where its results are not wanted any more.

#include <filesystem>

#include "oraclegs/core/progress.h"

namespace oraclegs {

/// Cancels the tasks that the record in `folder` (MakeSlurmLauncher's) has open and that Slurm still has, an array
/// included that was submitted by a process that died meanwhile, and waits until they have ended: none of them writes
/// any more. The record stays as it is. Nothing happens where there is no record, or all of it has ended. Throws
/// InputError when the record is damaged, RunError when the Slurm programs are missing or fail, another process uses
/// `folder`, or tasks do not end, and Interrupted.
void CancelOpenSlurmTasks(const std::filesystem::path& folder, const Listener& listener);

}  // namespace oraclegs
