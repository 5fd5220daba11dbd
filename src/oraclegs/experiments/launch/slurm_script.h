#pragma once
// The files of one array of tasks: what each runs, the script that Slurm starts, and what the script says of the end.
//
//   batch.sh     what Slurm starts for each task, as a copy of its own
//   3.sh         log, working folder and command of task 3
//   3.start      the number of the array, once task 3 runs
//   3.end        how it ended
//   slurm-3.out  what Slurm and the script itself have to say

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/experiments/launch/launcher.h"

namespace oraclegs {

/// How the command of a task ended, by the script that ran it.
struct SlurmTaskEnd {
  int exit_code = 0;          ///< 128 + n when killed by signal n
  double seconds = 0;         ///< of wall time
  int64_t peak_bytes = 0;     ///< resident, of the largest of its processes, once a second; 0 = not known
  bool asked_to_end = false;  ///< Slurm has sent SIGTERM before: cancelled, preempted or at its time limit
};

/// Writes batch.sh and the files of the tasks, `jobs` in their order from 0, to `folder`, whose path all machines have.
/// Throws RunError when it cannot be written.
void WriteSlurmTasks(const std::filesystem::path& folder, const std::vector<Job>& jobs);

/// Nothing while the task runs, or when it was killed with its script. Never throws: a damaged file is none.
std::optional<SlurmTaskEnd> ReadSlurmTaskEnd(const std::filesystem::path& folder, int task);

/// The number of the array by which a task of `folder` was started; "" when none was.
std::string ArrayOfStartedTasks(const std::filesystem::path& folder);

/// What the batch script itself has to say of a task, such as that its log cannot be opened.
std::filesystem::path SlurmOutput(const std::filesystem::path& folder, int task);

/// The pattern for sbatch's --output, which names the same files.
std::string SlurmOutputPattern(const std::filesystem::path& folder);

}  // namespace oraclegs
