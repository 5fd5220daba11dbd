#pragma once
// Runs the jobs of a suite on a cluster, as tasks of a job array of Slurm.

#include <chrono>
#include <filesystem>
#include <memory>

#include "oraclegs/experiments/launch/launcher.h"
#include "oraclegs/experiments/launch/slurm_options.h"

namespace oraclegs {

/// With a Slurm program that fails while jobs run: the controller may be down or being updated.
using SlurmPatience = std::chrono::duration<double>;

/// A launcher that submits the jobs with sbatch and follows them with squeue and, where the cluster has it, sacct.
/// `folder` must be seen by all machines of the cluster under the same path; it gets slurm.json, which has the numbers
/// of the arrays, and a folder for each array with its batch script, the command of each task and how it ended. Tasks
/// run in this process's working directory and with its environment.
///
/// Where this process dies, the tasks run on; Run with jobs of the same names and commands finds them again, and each
/// runs once. Where the command of a name has changed, the old task is cancelled first. A job whose end was reported
/// (`ended` has returned) and that is given again runs again.
///
/// Submitted again, up to `retries` times: what was cancelled or preempted, lost its machine, or failed, but for exit
/// codes of a wrong command or input (2, 3, 126, 127). An interrupt, and an exception of `ended`, cancels what runs.
/// Where one of the Slurm programs fails for longer than `patience`, what runs goes on and RunError is thrown. Run
/// throws RunError in one line when there is no sbatch, it refuses the jobs, or another process uses `folder`;
/// InputError when slurm.json is damaged.
std::unique_ptr<Launcher> MakeSlurmLauncher(const SlurmOptions& options, const std::filesystem::path& folder,
                                            SlurmPatience patience = std::chrono::minutes(30));

}  // namespace oraclegs
