#pragma once
// Files of one array of tasks: commands, the script that Slurm starts, and how each command ended.
//
//   batch.sh     started by Slurm for each task, as a copy of its own
//   3.sh         log, working folder and command of task 3
//   3.start      number of the array, once task 3 runs
//   3.end        how it ended
//   slurm-3.out  messages of Slurm and of the script itself

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/experiments/launch/launcher.h"

namespace oraclegs {

/// End of a task's command, as the script recorded it.
struct SlurmTaskEnd {
  int exit_code = 0;          ///< 128 + n when killed by signal n
  double seconds = 0;         ///< wall time
  int64_t peak_bytes = 0;     ///< resident memory of the largest of its processes, sampled once a second; 0 = not known
  bool asked_to_end = false;  ///< true when Slurm has sent SIGTERM before: cancelled, preempted or at its time limit
};

/// Writes batch.sh and the files of the tasks, `jobs` in their order from 0, to `folder`, which must have this path on
/// all machines. Throws RunError when it cannot be written.
void WriteSlurmTasks(const std::filesystem::path& folder, const std::vector<Job>& jobs);

/// nullopt while the task runs, when it was killed with its script, or when the file is damaged. Does not throw.
std::optional<SlurmTaskEnd> ReadSlurmTaskEnd(const std::filesystem::path& folder, int task);

/// Number of the array that started a task of `folder`; "" when none has started.
std::string ArrayOfStartedTasks(const std::filesystem::path& folder);

/// File with the batch script's own messages about a task, such as that its log cannot be opened.
std::filesystem::path SlurmOutput(const std::filesystem::path& folder, int task);

/// Pattern for sbatch's --output that names these files.
std::string SlurmOutputPattern(const std::filesystem::path& folder);

}  // namespace oraclegs
