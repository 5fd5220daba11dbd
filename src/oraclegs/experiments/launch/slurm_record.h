#pragma once
// Record of the submitted arrays, by which the next process finds them again.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

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

}  // namespace oraclegs
