#pragma once
// Launcher of a suite's jobs on a cluster, as tasks of a job array of Slurm.

#include <chrono>
#include <filesystem>
#include <memory>

#include "oraclegs/experiments/launch/launcher.h"
#include "oraclegs/experiments/launch/slurm_options.h"

namespace oraclegs {

/// Time for which a Slurm program may fail while jobs run: the controller may be down or being updated.
using SlurmPatience = std::chrono::duration<double>;

/// Launcher that submits the jobs with sbatch and follows them with squeue and, where the cluster has it, sacct. All
/// machines of the cluster must see `folder` under this path. It gets slurm.json with the numbers of the arrays, and a
/// folder for each array with its batch script, the command of each task and how it ended. Tasks run in this process's
/// working directory and with its environment.
///
/// When this process dies, the tasks run on. Run with jobs of the same names and commands finds them again, and each
/// runs once. Where the command of a name has changed, the old task is cancelled first. A job whose end was reported
/// (`ended` has returned) runs again when it is given again.
///
/// Jobs are submitted again, up to `retries` times, when they were cancelled or preempted, lost their machine, or
/// failed, except with exit codes of a wrong command or input (2, 3, 126, 127). An interrupt or an exception of `ended`
/// cancels the running tasks. When a Slurm program fails for longer than `patience`, the tasks run on and RunError is
/// thrown. Run throws RunError in one line when there is no sbatch, it refuses the jobs, or another process uses
/// `folder`; InputError when slurm.json is damaged.
std::unique_ptr<Launcher> MakeSlurmLauncher(const SlurmOptions& options, const std::filesystem::path& folder,
                                            SlurmPatience patience = std::chrono::minutes(30));

}  // namespace oraclegs
