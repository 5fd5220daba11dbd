#pragma once
// What a launcher remembers of the arrays that it submitted, so that the next process finds them again.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "oraclegs/experiments/launch/launcher.h"
#include "oraclegs/experiments/launch/slurm_programs.h"

namespace oraclegs {

struct SlurmRecord {
  struct Task {
    std::string job;         ///< its name
    std::string command;     ///< its digest
    int attempt = 0;         ///< how often the job was submitted before
    bool open = true;        ///< until its end was reported, or the job was submitted again
    bool cancelled = false;  ///< scancel was called for it
    bool operator==(const Task&) const = default;
  };
  struct Submission {
    std::string array;   ///< its number; "" while sbatch runs, or when this process died meanwhile
    std::string folder;  ///< below that of the record
    std::vector<Task> tasks;
    bool operator==(const Submission&) const = default;
  };

  std::string name;  ///< of all its jobs in Slurm, "oraclegs-" and 16 hexadecimal digits; no other record has it
  std::string cluster;
  std::vector<Submission> submissions;

  bool operator==(const SlurmRecord&) const = default;
};

/// Of a command: the same for the same words.
std::string SlurmCommandDigest(const Job& job);

/// Whether folder/slurm.json is there.
bool HasSlurmRecord(const std::filesystem::path& folder);

/// That of folder/slurm.json, or a new one with a name of its own. Throws InputError when the file is damaged, or names
/// jobs and folders as this program does not.
SlurmRecord ReadSlurmRecord(const std::filesystem::path& folder);

/// Throws RunError.
void WriteSlurmRecord(const std::filesystem::path& folder, const SlurmRecord& record);

}  // namespace oraclegs
