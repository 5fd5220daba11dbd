#pragma once
// Outcome of a task, from the queue, the accounts and the task's own files.

#include <filesystem>
#include <optional>

#include "oraclegs/experiments/launch/launcher.h"
#include "oraclegs/experiments/launch/slurm_programs.h"
#include "oraclegs/experiments/launch/slurm_script.h"

namespace oraclegs {

struct SlurmEvidence {
  std::optional<SlurmTaskState> queue;     ///< nullopt: squeue does not list the task (any more)
  std::optional<SlurmTaskState> accounts;  ///< nullopt: sacct does not know it, or there is no sacct
  std::optional<SlurmTaskEnd> file;        ///< nullopt: the script has not written its end (yet)
  int looks = 0;  ///< number of earlier looks that saw its end in one source and not in the other
};

/// Number of looks after which a shared file system should show a file that another machine has written, and Slurm
/// should have noticed the end of a script.
inline constexpr int kSlurmFileLooks = 3;

/// True when Slurm, not only the script, reports that the task has ended, or does not list it any more.
bool HasEndedInSlurm(const SlurmEvidence& evidence);

/// nullopt while it runs, or while the next look may know more. `why` names `log` where the log has the reason.
std::optional<JobResult> SlurmVerdict(const SlurmEvidence& evidence, const std::filesystem::path& log);

/// True when running the job again may end otherwise.
bool IsWorthAnotherTry(const JobResult& result);

}  // namespace oraclegs
