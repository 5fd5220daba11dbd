#pragma once
// Record of the submitted arrays, by which the next process finds them again, or cancels what is not wanted any more.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/core/progress.h"
#include "oraclegs/experiments/launch/launcher.h"
#include "oraclegs/experiments/launch/slurm_programs.h"

namespace oraclegs {

struct SlurmRecord {
  struct Task {
    std::string job;         ///< name of the job
    std::string command;     ///< SlurmCommandDigest of the job
    int attempt = 0;         ///< number of earlier submissions of the job
    bool open = true;        ///< until its end is reported or the job is submitted again
    bool cancelled = false;  ///< scancel was called for it
    bool operator==(const Task&) const = default;
  };
  struct Submission {
    std::string array;   ///< number of the array; "" while sbatch runs, or when this process died meanwhile
    std::string folder;  ///< folder below the record's
    std::vector<Task> tasks;
    bool operator==(const Submission&) const = default;
  };

  std::string name;  ///< name of all its jobs in Slurm: "oraclegs-" and 16 hexadecimal digits, unique to this record
  std::string cluster;
  std::vector<Submission> submissions;

  bool operator==(const SlurmRecord&) const = default;
};

/// Digest of a command, equal for equal words.
std::string SlurmCommandDigest(const Job& job);

/// True when folder/slurm.json exists.
bool HasSlurmRecord(const std::filesystem::path& folder);

/// Record in folder/slurm.json, or a new one with a new name. Throws InputError when the file is damaged, or names jobs
/// and folders in another form than this program.
SlurmRecord ReadSlurmRecord(const std::filesystem::path& folder);

/// Throws RunError.
void WriteSlurmRecord(const std::filesystem::path& folder, const SlurmRecord& record);

/// Cancels the open tasks of the record in `folder` (MakeSlurmLauncher's) that Slurm still has, including an array that
/// was submitted by a process that died meanwhile. Waits until they have ended, so that none of them writes any more.
/// The record stays unchanged. Does nothing without a record or without open tasks. Throws InputError when the record
/// is damaged, RunError when the Slurm programs are missing or fail, another process uses `folder`, or tasks do not
/// end, and Interrupted.
void CancelOpenSlurmTasks(const std::filesystem::path& folder, const Listener& listener);

}  // namespace oraclegs
