#pragma once
// What became of a task, of what the queue, the accounts and the task's own files say of it.

#include <filesystem>
#include <optional>

#include "oraclegs/experiments/launch/launcher.h"
#include "oraclegs/experiments/launch/slurm_programs.h"
#include "oraclegs/experiments/launch/slurm_script.h"

namespace oraclegs {

struct SlurmEvidence {
  std::optional<SlurmTaskState> queue;     ///< nothing: squeue does not list the task (any more)
  std::optional<SlurmTaskState> accounts;  ///< nothing: sacct does not know it, or there is none
  std::optional<SlurmTaskEnd> file;        ///< nothing: the script has not written how it ended (yet)
  int looks = 0;                           ///< before this one that saw it ended by the one and not by the other
};

/// How many looks a shared file system is given to show a file that another machine has written, and Slurm to notice
/// the end of a script.
inline constexpr int kSlurmFileLooks = 3;

/// Whether Slurm, not only the script, says that the task has ended, or does not list it any more.
bool HasEndedInSlurm(const SlurmEvidence& evidence);

/// Nothing while it runs, or while the next look may know more. `why` names `log` where it has the reason.
std::optional<JobResult> SlurmVerdict(const SlurmEvidence& evidence, const std::filesystem::path& log);

/// Whether running the job again may end otherwise.
bool IsWorthAnotherTry(const JobResult& result);

}  // namespace oraclegs
