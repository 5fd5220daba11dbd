#pragma once
// Cancels tasks that an earlier process left running on a cluster and whose results are not wanted any more.

#include <filesystem>

#include "oraclegs/core/progress.h"

namespace oraclegs {

/// Cancels the open tasks of the record in `folder` (MakeSlurmLauncher's) that Slurm still has, including an array that
/// was submitted by a process that died meanwhile. Waits until they have ended, so that none of them writes any more.
/// The record stays unchanged. Does nothing without a record or without open tasks. Throws InputError when the record
/// is damaged, RunError when the Slurm programs are missing or fail, another process uses `folder`, or tasks do not
/// end, and Interrupted.
void CancelOpenSlurmTasks(const std::filesystem::path& folder, const Listener& listener);

}  // namespace oraclegs
